#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace flatspeckle::mc {

/// A least-squares problem within bounds. Residuals are in standard errors.
struct LeastSquares {
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residuals;
  /// Derivatives of the residuals, [residual][parameter]; asked for at accepted points alone.
  std::function<Eigen::MatrixXd(const Eigen::VectorXd&)> jacobian;
  Eigen::VectorXd lower, upper;
};

struct LeastSquaresFit {
  Eigen::VectorXd parameters, residuals;
  Eigen::MatrixXd jacobian;
  int iterations = 0;
  bool converged = false;

  double chi_squared() const { return residuals.squaredNorm(); }
};

/// Levenberg's and Marquardt's steps, cut off at the bounds; a parameter that its bound holds back
/// takes no part in a step. Converged: the step that is left is less than `tolerance` of the
/// distance of the bounds, or lessens chi^2 by less than `tolerance`.
LeastSquaresFit levenberg_marquardt(const LeastSquares& problem, const Eigen::VectorXd& start,
                                    int most_iterations = 60, double tolerance = 1e-6);

/// The least chi^2 of all starts, of those that converged if any did.
LeastSquaresFit best_fit(const LeastSquares& problem, const std::vector<Eigen::VectorXd>& starts);

/// What measurements say of the parameters, linear about a point: of the Fisher information J^T J
/// of residuals in standard errors.
struct Information {
  Eigen::MatrixXd covariance, correlation;
  double condition = 0;  ///< of the information of parameters in units of the distance of bounds
  Eigen::VectorXd best, worst;  ///< known combinations of those, of length 1

  Eigen::VectorXd errors() const { return covariance.diagonal().cwiseSqrt(); }
};

/// An infinite condition, and no covariance, where a combination is not known at all.
Information information(const LeastSquares& problem, const Eigen::MatrixXd& jacobian);

}  // namespace flatspeckle::mc
