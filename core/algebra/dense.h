#pragma once

#include <complex>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// As datasets have it: last axis fastest.
inline std::vector<double> row_major(const Eigen::MatrixXd& values) {
  const Eigen::MatrixXd columns = values.transpose();
  return {columns.data(), columns.data() + columns.size()};
}

using Matrix = Eigen::MatrixXd;
/// Complex rows, one for each channel: in memory a real matrix of twice as many rows, so that
/// products with real matrices are real ones.
using Rows = Eigen::MatrixXcd;

/// Dense algebra by the system's BLAS and LAPACK, on one thread.
Matrix product(const Matrix& a, const Matrix& b);
Rows product(const Rows& rows, const Matrix& a);
Rows product(const Rows& a, const Rows& b);
/// a b^T
Rows product_transposed(const Rows& a, const Rows& b);
/// Each row times its factor.
Rows scaled(std::span<const std::complex<double>> factor, Rows rows);

/// LU factors of a square matrix a. Throws std::runtime_error for a singular one.
template <typename M>
class FactorsOf {
 public:
  explicit FactorsOf(M a);
  /// a^-1 b
  M before(M b) const;
  /// rows a^-1
  Rows after(Rows rows) const;

 private:
  M factors_;
  std::vector<int> pivots_;
};

}  // namespace flatspeckle
