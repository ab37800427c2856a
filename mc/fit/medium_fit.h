#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/search/levenberg_marquardt.h"
#include "mc/fit/task/fit_task.h"

namespace flatspeckle::mc {

/// A quantity derived from the parameters, with its error. low, high: least and largest value at
/// the ends of the intervals of the parameters.
struct Derived {
  std::string name, unit;
  double value = 0, error = 0, low = 0, high = 0;
};

struct MediumFit {
  Eigen::VectorXd coordinates;  ///< estimates, as coordinates (FreeParameter)
  Eigen::VectorXd estimates, errors;
  /// Intervals of the parameters in which chi^2, minimised over the others, exceeds its minimum by
  /// less than interval_rise: two standard errors. Empty for measured fields and Monte Carlo.
  Eigen::VectorXd low, high;
  /// Whether these intervals differ from two standard errors.
  bool is_quadratic = true;
  Eigen::MatrixXd covariance, correlation;
  /// Condition number of the Fisher information; infinite if a combination of the parameters is not
  /// determined.
  double condition = 0;
  /// Least determined combination of the parameters, in units of the distances between their
  /// bounds.
  Eigen::VectorXd worst;
  /// For each parameter, whether its error is below a quarter of the distance between its bounds.
  std::vector<bool> known;
  std::vector<Derived> derived;
  Eigen::VectorXd model;      ///< model values for all measurements, concatenated
  Eigen::VectorXd residuals;  ///< whitened residuals: independent, in units of standard errors
  Eigen::VectorXd standardized_residuals;  ///< (measured - model) / error of each value
  double chi_squared = 0;
  /// Expected chi^2 if the medium is correct: the number of values minus the number of parameters.
  /// It is less if the errors of the values are so strongly correlated that some combinations
  /// hardly contribute.
  double degrees_of_freedom = 0;
  std::optional<Invariant> derivative_check;  ///< check of the derivatives; only for transport
  double numerical = 0;  ///< largest numerical error of the model, in standard errors
  // Only for Monte Carlo: the parts of `covariance` that come from sampling noise of the model and
  // from neglected wave effects.
  Eigen::MatrixXd by_sampling, by_neglect;
  double paths = 0;  ///< only for Monte Carlo: number of paths of each run at the best medium
  bool converged = false, reversed = false;
  /// Accepted steps of the search. They contain values of the parameters, not coordinates.
  std::vector<LeastSquaresFit::Step> trace;
};

constexpr double interval_rise = 4;

/// Throws InputError if the measurements do not determine the parameters, or the scene is not
/// valid.
void check(const FitTask& task);

/// Fits all measurements at once by least squares. Throws InputError.
MediumFit fit_medium(const FitTask& task);

/// Fits by least squares with a Monte Carlo model, in any medium. The errors of the model are added
/// to those of the measurements. Paths are sampled until sampling noise adds at most the fraction
/// PathSettings::share to the variances of the estimates. Throws InputError.
MediumFit fit_by_paths(const FitTask& task);

/// Throws InputError for measurements that the Monte Carlo model does not support.
void check_paths(const FitTask& task);

/// Returns the values of the parameters at these coordinates.
Eigen::VectorXd values_at(const FitTask& task, const Eigen::VectorXd& coordinates);

/// Sets the members of `fit` that follow from the Fisher information at a point: estimates, errors,
/// which parameters are determined, and derived quantities.
void put_information(const FitTask& task, const Information& known,
                     const Eigen::VectorXd& coordinates, MediumFit& fit);

/// Transforms a covariance of coordinates to one of values.
Eigen::MatrixXd covariance_of_values(const FitTask& task, const Eigen::VectorXd& coordinates,
                                     const Eigen::MatrixXd& covariance);

/// Whether chi^2 is consistent with noise, within four standard deviations.
bool is_likely(double chi_squared, double degrees_of_freedom);

}  // namespace flatspeckle::mc
