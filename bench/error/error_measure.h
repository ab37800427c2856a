#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/error/error_curve.h"
#include "core/run/runner.h"

namespace flatspeckle::bench {

/// One seed of a method: numbered batches, and how their sums are read.
struct Trial {
  BatchJob batches;
  Estimator values;
};

struct Method {
  std::string scene, name;
  std::function<Trial(std::uint64_t seed)> trial;
  std::uint64_t first_point = 1;  ///< batches of the first point of a curve
  bool is_monte_carlo = true;     ///< see ErrorCurve
  double share = 1;               ///< of the time, for dear ones
  bool slow = false;              ///< see ErrorRun
};

/// What a curve is compared with.
struct ErrorReference {
  std::vector<Complex> value;
  double relative_error = 0;  ///< RMS over the entries, relative to their RMS
  std::string how;            ///< it is known, in words
};

/// RMS over the entries of what `values` are off by, relative to the RMS of the reference.
double relative_distance(const std::vector<Complex>& values, const ErrorReference& reference);

/// Runs of many seeds, each to the same number of batches, with a point whenever a run's batches
/// have doubled. All points see the same number of runs, so that a method without finite variance
/// is seen: its error falls more slowly. Slope by least squares, weighted by the points' own
/// errors; its error by leaving one run out at a time, with what the reference may be off by.
ErrorCurve measure_error(const Method& method, const ErrorReference& reference, double cpu_seconds);

/// Slope by plain least squares through all points, and the efficiency of the last: of curves whose
/// points have nothing in common.
void set_plain_slope(ErrorCurve& curve);

}  // namespace flatspeckle::bench
