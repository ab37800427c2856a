#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "mc/fit/task/free_parameter.h"
#include "mc/fit/task/measurement.h"

namespace flatspeckle::mc {

/// Settings of a Monte Carlo model that is fitted.
struct PathSettings {
  std::uint64_t seed = 1;
  int threads = 1;
  /// Fraction that sampling noise of the model may add to the variances of the estimates.
  double share = 0.2;
  std::optional<double> seconds;  ///< time after which no more paths are sampled
  bool trusted = false;           ///< true: no errors are added for wave effects that paths neglect
};

/// State of a search by Monte Carlo, sufficient to resume it.
struct FitStep {
  std::size_t start = 0;  ///< index of the start point of the search
  int iteration = 0;
  double paths = 0, damping = 0;
  /// cpu_s: processor time of this process so far.
  double chi_squared = 0, cpu_s = 0;
  Eigen::VectorXd at;
};

/// An inverse problem: the free parameters of a medium and the measurements that determine them.
struct FitTask {
  std::vector<FreeParameter> free;
  std::vector<Measurement> measurements;
  int starts = 2;  ///< number of start values of each parameter that has no given start
  int most_iterations = 60;
  /// If set, the model is computed by Monte Carlo, else by transport.
  std::optional<PathSettings> paths;
  // For a search by Monte Carlo: callback for each step, and steps of an earlier run.
  std::function<void(const FitStep&)> keep{};
  std::vector<FitStep> made{};

  /// Callback for each medium whose model has been computed, with chi^2 there; infinity if it is
  /// not known.
  std::function<void(double chi_squared)> tried{};

  void report(double chi_squared = std::numeric_limits<double>::infinity()) const {
    if (tried) tried(chi_squared);
  }

  /// Whether any curve is a function of delays or exposures.
  bool moving() const {
    for (const Measurement& one : measurements)
      for (const Curve& curve : one.curves)
        if (curve.moving()) return true;
    return false;
  }
  /// Whether any values are those of detectors at distances from a beam.
  bool at_distances() const {
    for (const Measurement& one : measurements)
      for (const Curve& curve : one.curves)
        if (curve.distances) return true;
    return false;
  }
};

}  // namespace flatspeckle::mc
