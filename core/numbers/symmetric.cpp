#include "core/numbers/symmetric.h"

#include <algorithm>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/numbers/blas.h"

namespace flatspeckle {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a) {
  blas_single_thread();
  SymmetricEigen found{Eigen::VectorXd(a.rows()), a};
  const blasint n = blas_size(static_cast<std::size_t>(a.rows())), height = std::max<blasint>(n, 1);
  if (LAPACKE_dsyev(LAPACK_COL_MAJOR, 'V', 'L', n, found.vectors.data(), height, found.values.data()) != 0)
    found.values.setConstant(std::numeric_limits<double>::quiet_NaN());
  return found;
}

SymmetricEigen tridiagonal_eigen(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& beside) {
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, beside);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.ldlt().solve(b);
}

Eigen::MatrixXd inverse_symmetric(const Eigen::MatrixXd& a) {
  return a.ldlt().solve(Eigen::MatrixXd::Identity(a.rows(), a.cols()));
}

}  // namespace flatspeckle
