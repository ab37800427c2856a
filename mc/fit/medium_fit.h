#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/search/levenberg_marquardt.h"
#include "mc/fit/task/fit_task.h"

namespace flatspeckle::mc {

/// What follows from the parameters, and how well it is known.
struct Derived {
  std::string name, unit;
  double value = 0, error = 0;
};

struct MediumFit {
  Eigen::VectorXd coordinates;  ///< of the estimates
  Eigen::VectorXd estimates, errors;
  Eigen::MatrixXd covariance, correlation;
  double condition = 0;   ///< of the information; infinite where a combination is not known
  Eigen::VectorXd worst;  ///< known combination of the parameters, in distances of their bounds
  std::vector<bool>
      known;  ///< better than the bounds tell: by less than a quarter of their distance
  std::vector<Derived> derived;
  Eigen::VectorXd model;      ///< of all measurements, one after the other
  Eigen::VectorXd residuals;  ///< whitened: independent, in standard errors
  Eigen::VectorXd pulls;      ///< (measured - model) / error of each value
  double chi_squared = 0;
  /// Its mean if the medium is right: values less parameters, or less where their errors are so
  /// correlated that some combinations of them hardly count.
  double degrees_of_freedom = 0;
  std::optional<Invariant> slope;  ///< of the derivatives, by transport
  double numerical = 0;            ///< largest numerical error of the model, in standard errors
  // By Monte Carlo, parts of the covariance: of chance, and of what paths neglect of waves.
  Eigen::MatrixXd by_chance, by_neglect;
  double paths = 0;  ///< by Monte Carlo: those of each run at the best medium
  bool converged = false, reversed = false;
  std::vector<LeastSquaresFit::Step> trace;  ///< with values of the parameters
};

/// Throws InputError for what the measurements cannot tell, or the scene cannot be.
void check(const FitTask& task);

/// Least squares of all measurements at once. Throws InputError.
MediumFit fit_medium(const FitTask& task);

/// Least squares by Monte Carlo, in any medium: the errors of the model count beside those of the
/// measurements, and paths become more until they add no more than the stated share. Throws
/// InputError.
MediumFit fit_by_paths(const FitTask& task);

/// Throws InputError for what paths cannot tell.
void check_paths(const FitTask& task);

/// Values of the parameters at coordinates.
Eigen::VectorXd values_at(const FitTask& task, const Eigen::VectorXd& coordinates);

/// What follows of the parameters from their information about a point: estimates, errors, what is
/// known, what is derived.
void put_information(const FitTask& task, const Information& known,
                     const Eigen::VectorXd& coordinates, MediumFit& fit);

/// Of coordinates, as one of values.
Eigen::MatrixXd covariance_of_values(const FitTask& task, const Eigen::VectorXd& coordinates,
                                     const Eigen::MatrixXd& covariance);

/// Whether chi^2 is no more than noise makes it, to four standard deviations.
bool is_likely(double chi_squared, double degrees_of_freedom);

}  // namespace flatspeckle::mc
