#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mc/fit/free_parameter.h"
#include "mc/fit/levenberg_marquardt.h"
#include "mc/fit/measurement.h"

namespace flatspeckle::mc {

/// How a model by Monte Carlo is sampled.
struct PathSettings {
  std::uint64_t seed = 1;
  int threads = 1;
  double share = 0.2;             ///< of errors' variances, that chance in the model may add
  std::optional<double> seconds;  ///< after which no more paths are drawn
};

/// Which medium gave these measurements?
struct FitTask {
  std::vector<FreeParameter> free;
  std::vector<Measurement> measurements;
  int starts = 2;  ///< of each parameter without a start
  int most_iterations = 60;
  std::optional<PathSettings> paths;  ///< the model is by Monte Carlo; else by transport
};

/// What follows from the parameters, and how well it is known.
struct Derived {
  std::string name, unit;
  double value = 0, error = 0;
};

struct MediumFit {
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
  double numerical = 0;       ///< largest numerical error of the model, in standard errors
  Eigen::MatrixXd by_chance;  ///< by Monte Carlo: its part of the covariance
  double paths = 0;           ///< by Monte Carlo: those of each run at the best medium
  bool converged = false, reversed = false;
  std::vector<LeastSquaresFit::Step> trace;  ///< with values of the parameters

  Eigen::Index degrees_of_freedom() const { return residuals.size() - estimates.size(); }
};

/// Throws InputError for what the measurements cannot tell, or the scene cannot be.
void check(const FitTask& task);

/// Least squares of all measurements at once. Throws InputError.
MediumFit fit_medium(const FitTask& task);

}  // namespace flatspeckle::mc
