#pragma once

#include <Eigen/Core>

namespace flatspeckle {

/// Eigenvalues of a symmetric matrix in increasing order, and eigenvectors as the columns of a
/// matrix.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// Returns the eigenvalues and eigenvectors of a symmetric matrix, by the QR algorithm of LAPACK
/// (that of Eigen takes ten seconds to compile). The eigenvalues are NaN if an element is not
/// finite.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);

/// Returns the eigenvalues and eigenvectors of a symmetric tridiagonal n x n matrix. beside: the n
/// - 1 elements next to the diagonal.
SymmetricEigen tridiagonal_eigen(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& beside);

/// Returns a^-1 b for a symmetric matrix a, by pivoted LDL^T decomposition. If a is singular but
/// positive semidefinite, its singular directions are left out.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd inverse_symmetric(const Eigen::MatrixXd& a);

}  // namespace flatspeckle
