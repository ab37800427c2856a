#pragma once

#include <Eigen/Core>

namespace flatspeckle {

/// Eigenvalues, ascending, and eigenvectors, one a column.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// Decomposes a symmetric matrix by LAPACK's tridiagonal QR (Eigen's takes ten seconds to compile). The values are
/// NaN where an element is not finite.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);

/// Of a symmetric tridiagonal matrix; beside: the n - 1 elements next to the diagonal.
SymmetricEigen tridiagonal_eigen(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& beside);

/// a^-1 b of a symmetric matrix, by LDL^T with pivots; singular directions of a positive
/// semidefinite one are left out.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd inverse_symmetric(const Eigen::MatrixXd& a);

}  // namespace flatspeckle
