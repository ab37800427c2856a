#pragma once

#include <complex>
#include <span>

#include <Eigen/Core>

#include "core/numbers/complex.h"

namespace flatspeckle::mc {

using Matrix = Eigen::MatrixXd;
/// Complex rows, one for each channel: in memory a real matrix of twice as many rows, so that
/// products with real matrices are real ones.
using Rows = Eigen::MatrixXcd;

using flatspeckle::product;  // of numbers, which these would hide

/// Dense algebra by the system's BLAS and LAPACK, on one thread.
Matrix product(const Matrix& a, const Matrix& b);
Rows product(const Rows& rows, const Matrix& a);
/// a b^T
Rows product_transposed(const Rows& a, const Rows& b);
/// Each row times its factor.
Rows scaled(std::span<const std::complex<double>> factor, Rows rows);
/// Throws std::runtime_error for a singular matrix.
Matrix inverse(Matrix a);

}  // namespace flatspeckle::mc
