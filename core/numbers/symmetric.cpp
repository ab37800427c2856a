#include "core/numbers/symmetric.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace flatspeckle {

namespace {

using Solver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

SymmetricEigen found_by(const Solver& solver) {
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a) {
  return found_by(Solver(a));
}

SymmetricEigen tridiagonal_eigen(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& beside) {
  Solver solver;
  solver.computeFromTridiagonal(diagonal, beside);
  return found_by(solver);
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.ldlt().solve(b);
}

Eigen::MatrixXd inverse_symmetric(const Eigen::MatrixXd& a) {
  return a.ldlt().solve(Eigen::MatrixXd::Identity(a.rows(), a.cols()));
}

}  // namespace flatspeckle
