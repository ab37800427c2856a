#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/result/invariant.h"

namespace flatspeckle {

/// A least-squares problem: minimise the sum of the squares of residuals(parameters), with bounds
/// of the parameters. Residuals are in units of the standard errors.
struct BoundedLeastSquares {
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residuals;
  /// Returns the derivatives of the residuals as a matrix [residual][parameter]. It is given the
  /// parameters and the residuals there, and is called only for accepted parameters.
  std::function<Eigen::MatrixXd(const Eigen::VectorXd&, const Eigen::VectorXd& residuals)> jacobian;
  Eigen::VectorXd lower, upper;
};

struct LeastSquaresFit {
  /// Parameters that the search has accepted, and chi^2 there.
  struct Step {
    Eigen::VectorXd parameters;
    double chi_squared, cpu_s;  ///< cpu_s: processor seconds that this process had used by then
  };
  Eigen::VectorXd parameters, residuals;
  Eigen::MatrixXd jacobian;
  int iterations = 0;
  bool converged = false;
  std::vector<Step> trace;

  double chi_squared() const { return residuals.squaredNorm(); }
};

/// Minimises chi^2 by Levenberg-Marquardt steps that are clipped at the bounds. A parameter at a
/// bound that would move beyond it is kept fixed in that step. The search has converged if the last
/// step has reduced chi^2 by less than `tolerance`, or if the next step is shorter than
/// sqrt(tolerance) standard errors.
LeastSquaresFit levenberg_marquardt(const BoundedLeastSquares& problem,
                                    const Eigen::VectorXd& start, int most_iterations = 60,
                                    double tolerance = 1e-6);

/// Returns the damped Gauss-Newton step from the parameters of `at`, whose residuals and Jacobian
/// are known. Parameters at a bound that would move beyond it are kept fixed.
Eigen::VectorXd damped_step(const BoundedLeastSquares& problem, const LeastSquaresFit& at,
                            double damping);

/// Returns the Jacobian of the residuals by one-sided finite differences. Each difference is taken
/// towards the middle of the bounds, because the model may not be defined beyond them. here:
/// residuals at the parameters `at`. step: relative to the distance of the bounds.
Eigen::MatrixXd jacobian(const BoundedLeastSquares& problem, const Eigen::VectorXd& at,
                         const Eigen::VectorXd& here, double step = 1e-3);

/// Checks one column of the Jacobian of a fit, that of the parameter which the residuals determine
/// best, against central finite differences. The limit of the invariant follows from the curvature
/// of the residuals. Returns nullopt if the parameter is too close to a bound.
std::optional<Invariant> check_derivative(const BoundedLeastSquares& problem,
                                          const LeastSquaresFit& fit);

/// Returns the `most` start points of least chi^2, or all if there are fewer.
std::vector<Eigen::VectorXd> best_starts(const BoundedLeastSquares& problem,
                                         const std::vector<Eigen::VectorXd>& starts,
                                         std::size_t most);

/// Fits from each start point, and returns the fit of least chi^2 among the converged fits, or
/// among all fits if none has converged.
LeastSquaresFit best_fit(const BoundedLeastSquares& problem,
                         const std::vector<Eigen::VectorXd>& starts, int most_iterations = 60,
                         double tolerance = 1e-6);

/// Errors and correlations of fitted parameters, from the Fisher information J^T J, where J is the
/// Jacobian of residuals in units of the standard errors. The error of a combination of parameters
/// that is not determined is limited to a million times the distance of the bounds.
struct Information {
  Eigen::MatrixXd covariance, correlation;
  /// Condition number of the Fisher matrix for parameters in units of the distance of their bounds.
  double condition = 0;
  /// Combinations of the parameters that are determined best and worst, as vectors of length 1.
  Eigen::VectorXd best, worst;

  Eigen::VectorXd errors() const { return covariance.diagonal().cwiseSqrt(); }
};

/// Returns the expectation of chi^2 of the best fit (the degrees of freedom) if the model is
/// linear. errors: covariance matrix of the residuals; if it is the identity, the result is the
/// number of residuals minus the number of parameters.
double expected_chi_squared(const Eigen::MatrixXd& errors, const Eigen::MatrixXd& jacobian);

/// Returns errors and correlations of the parameters from a Jacobian. The condition number is
/// infinite if a combination of parameters is not determined.
Information information(const BoundedLeastSquares& problem, const Eigen::MatrixXd& jacobian);
/// Returns errors and correlations of the parameters from a Fisher matrix J^T J.
Information information_of(const BoundedLeastSquares& problem, const Eigen::MatrixXd& fisher);

}  // namespace flatspeckle
