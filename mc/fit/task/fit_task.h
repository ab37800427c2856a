#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "mc/fit/task/free_parameter.h"
#include "mc/fit/task/measurement.h"

namespace flatspeckle::mc {

/// How a model by Monte Carlo is sampled.
struct PathSettings {
  std::uint64_t seed = 1;
  int threads = 1;
  double share = 0.2;             ///< of errors' variances, that chance in the model may add
  std::optional<double> seconds;  ///< after which no more paths are drawn
  bool trusted = false;           ///< what paths neglect of waves counts as no error
};

/// Where a search by Monte Carlo stands: all that it needs to go on.
struct FitStep {
  std::size_t start = 0;  ///< which of the starts
  int iteration = 0;
  double paths = 0, damping = 0;
  double chi_squared = 0, cpu_s = 0;  ///< of this process, so far
  Eigen::VectorXd at;
};

/// Which medium gave these measurements?
struct FitTask {
  std::vector<FreeParameter> free;
  std::vector<Measurement> measurements;
  int starts = 2;  ///< of each parameter without a start
  int most_iterations = 60;
  std::optional<PathSettings> paths;  ///< the model is by Monte Carlo; else by transport
  // Of a search by Monte Carlo: what is told of each step, and steps that were made before.
  std::function<void(const FitStep&)> keep{};
  std::vector<FitStep> made{};

  /// Whether any curve is of delays or exposures.
  bool moving() const {
    for (const Measurement& one : measurements)
      for (const Curve& curve : one.curves)
        if (curve.moving()) return true;
    return false;
  }
};

}  // namespace flatspeckle::mc
