#pragma once

#include <complex>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Returns the values in row-major order (last axis fastest), as datasets store them.
inline std::vector<double> row_major(const Eigen::MatrixXd& values) {
  const Eigen::MatrixXd columns = values.transpose();
  return {columns.data(), columns.data() + columns.size()};
}

using Matrix = Eigen::MatrixXd;
/// Complex matrix with one row per channel (a pair of light and view). BLAS treats it as a real
/// matrix with twice as many rows, so that products with real matrices use real arithmetic.
using Rows = Eigen::MatrixXcd;

/// Returns the product a b of two matrices. All dense algebra here uses the system's BLAS and
/// LAPACK, on one thread.
Matrix product(const Matrix& a, const Matrix& b);
Rows product(const Rows& rows, const Matrix& a);
Rows product(const Rows& a, const Rows& b);
/// Returns the product a b^T of a matrix and a transposed matrix.
Rows product_transposed(const Rows& a, const Rows& b);
/// Returns the matrix `rows` after multiplying its row i by factor[i].
Rows scaled(std::span<const std::complex<double>> factor, Rows rows);

/// LU factors of a square matrix a, to solve linear systems. Throws std::runtime_error if a is
/// singular.
template <typename M>
class FactorsOf {
 public:
  explicit FactorsOf(M a);
  /// Returns a^-1 b: solves a x = b.
  M before(M b) const;
  /// Returns rows a^-1: solves x a = rows.
  Rows after(Rows rows) const;

 private:
  M factors_;
  std::vector<int> pivots_;
};

}  // namespace flatspeckle
