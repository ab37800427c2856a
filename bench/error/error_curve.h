#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flatspeckle::bench {

/// What independent runs of a method are off by after so much time, RMS over the runs and over the
/// entries, relative to the RMS of the reference; what the reference itself is off by is taken off.
struct ErrorPoint {
  double cpu_s;    ///< of one run on one thread, set-up not counted
  double samples;  ///< 0 of a solution without chance
  double error;
  double error_error;  ///< standard error of `error`, from the spread of the runs
};

/// Error against time of one method on one scene.
struct ErrorCurve {
  std::string scene, method;
  std::string reference;  ///< what it is compared with, and how that is known
  double reference_error = 0;
  std::vector<ErrorPoint> points;
  double slope = 0;        ///< of log error against log cpu_s
  double slope_error = 0;  ///< standard error, with what the points have in common
  double efficiency = 0;   ///< 1 / (error^2 cpu_s)
  /// Unbiased and of finite variance, so that the slope must be -1/2.
  bool is_monte_carlo = true;
  /// A solution without chance has a point per tolerance, and no slope.
  bool has_slope() const { return points.front().samples > 0; }
};

struct ErrorRun {
  std::string scene, method;
  /// On the calling thread alone, in about so many CPU seconds.
  std::function<ErrorCurve(double cpu_seconds)> run;
  bool slow = false;  ///< takes seconds however few it is given: not for a quick look
};

/// Every method on every scene: independent of each other, any of them at once.
std::vector<ErrorRun> error_runs();

}  // namespace flatspeckle::bench
