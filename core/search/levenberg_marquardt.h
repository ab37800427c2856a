#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/result/invariant.h"

namespace flatspeckle {

/// A least-squares problem within bounds. Residuals are in standard errors.
struct BoundedLeastSquares {
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> residuals;
  /// Derivatives of the residuals, [residual][parameter], at a point of known residuals; asked for
  /// at accepted points alone.
  std::function<Eigen::MatrixXd(const Eigen::VectorXd&, const Eigen::VectorXd& residuals)> jacobian;
  Eigen::VectorXd lower, upper;
};

struct LeastSquaresFit {
  /// An accepted point.
  struct Step {
    Eigen::VectorXd parameters;
    double chi_squared, cpu_s;  ///< of this process, so far
  };
  Eigen::VectorXd parameters, residuals;
  Eigen::MatrixXd jacobian;
  int iterations = 0;
  bool converged = false;
  std::vector<Step> trace;

  double chi_squared() const { return residuals.squaredNorm(); }
};

/// Levenberg's and Marquardt's steps, cut off at the bounds; a parameter that its bound holds back
/// takes no part in a step. Converged: the last step has lessened chi^2 by less than `tolerance`,
/// or the next one would be shorter than its root, in standard errors.
LeastSquaresFit levenberg_marquardt(const BoundedLeastSquares& problem,
                                    const Eigen::VectorXd& start, int most_iterations = 60,
                                    double tolerance = 1e-6);

/// The step from a point of known residuals and jacobian; what a bound holds back takes no part.
Eigen::VectorXd damped_step(const BoundedLeastSquares& problem, const LeastSquaresFit& at,
                            double damping);

/// Derivatives by coordinates, in differences towards the middle, for a bound may be the end of
/// what can be computed. residuals: at a point; here: those of `at`.
Eigen::MatrixXd jacobian(const BoundedLeastSquares& problem, const Eigen::VectorXd& at,
                         const Eigen::VectorXd& here);

/// Compares the jacobian of a fit with central differences of the residuals, by the parameter that
/// these determine best; the limit follows from the curvature there. Returns nullopt beside a
/// bound.
std::optional<Invariant> check_slope(const BoundedLeastSquares& problem,
                                     const LeastSquaresFit& fit);

/// Of all starts, those of the least chi^2.
std::vector<Eigen::VectorXd> best_starts(const BoundedLeastSquares& problem,
                                         const std::vector<Eigen::VectorXd>& starts,
                                         std::size_t most);

/// The least chi^2 of all starts, of those that converged if any did.
LeastSquaresFit best_fit(const BoundedLeastSquares& problem,
                         const std::vector<Eigen::VectorXd>& starts, int most_iterations = 60,
                         double tolerance = 1e-6);

/// What measurements say of the parameters, linear about a point: of the Fisher information J^T J
/// of residuals in standard errors. A combination of which they tell nothing has an error of up to
/// a million times the distance of the bounds.
struct Information {
  Eigen::MatrixXd covariance, correlation;
  double condition = 0;  ///< of the information of parameters in units of the distance of bounds
  Eigen::VectorXd best, worst;  ///< known combinations of those, of length 1

  Eigen::VectorXd errors() const { return covariance.diagonal().cwiseSqrt(); }
};

/// The mean of chi^2 at the best fit of a linear model, its degrees of freedom: of residuals whose
/// errors have this covariance. Residuals less parameters, where that is the identity.
double expected_chi_squared(const Eigen::MatrixXd& errors, const Eigen::MatrixXd& jacobian);

/// An infinite condition where a combination is not known at all.
Information information(const BoundedLeastSquares& problem, const Eigen::MatrixXd& jacobian);
/// fisher: J^T J.
Information information_of(const BoundedLeastSquares& problem, const Eigen::MatrixXd& fisher);

}  // namespace flatspeckle
