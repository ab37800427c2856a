#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flatspeckle::bench {

/// Point of an error curve: deviation of a method from the reference after a given time. It is the
/// RMS over independent runs and over the entries of the result, divided by the RMS of the
/// reference. The squared error of the reference is subtracted before the root is taken.
struct ErrorPoint {
  double cpu_s;    ///< CPU time of one run on one thread, without set-up
  double samples;  ///< 0 for a deterministic solution
  double error;
  double error_error;  ///< standard error of `error`, from the spread of the runs
};

/// Error against time of one method on one scene.
struct ErrorCurve {
  std::string scene, method;
  std::string reference;  ///< reference solution and its origin
  double reference_error = 0;
  std::vector<ErrorPoint> points;
  double slope = 0;        ///< slope of log error against log cpu_s
  double slope_error = 0;  ///< standard error, including the correlation of the points
  double efficiency = 0;   ///< 1 / (error^2 cpu_s)
  /// Whether the method is unbiased with finite variance, so that the slope must be -1/2.
  bool is_monte_carlo = true;
  /// False for deterministic solutions, which have one point per tolerance and no slope.
  bool has_slope() const { return points.front().samples > 0; }
};

struct ErrorRun {
  std::string scene, method;
  /// Measures the curve on the calling thread alone, in about this many CPU seconds.
  std::function<ErrorCurve(double cpu_seconds)> run;
  bool slow = false;  ///< takes seconds even for a smaller time budget; omitted from quick runs
};

/// Returns one run for each method on each scene. The runs are independent and may execute
/// concurrently.
std::vector<ErrorRun> error_runs();

}  // namespace flatspeckle::bench
