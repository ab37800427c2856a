#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/error/error_curve.h"
#include "core/run/runner.h"

namespace flatspeckle::bench {

/// One seed of a method: numbered batches, and how their sums are read.
struct ErrorTrial {
  BatchJob batches;
  Estimator values;
};

struct ErrorMethod {
  std::string scene, name;
  std::function<ErrorTrial(std::uint64_t seed)> trial;
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
ErrorCurve measure_error(const ErrorMethod& method, const ErrorReference& reference,
                         double cpu_seconds);

/// A curve against a reference that is made once it is measured.
ErrorRun run_of(const ErrorMethod& method, const std::function<ErrorReference()>& reference);

/// A curve of points that have nothing in common: as long as there is time, and `next` makes one,
/// and it is not as good as the reference. Slope by plain least squares through all of them,
/// efficiency of the last.
void measure_points(ErrorCurve& curve, double cpu_seconds,
                    const std::function<std::optional<ErrorPoint>()>& next);

/// The RMS of what runs of seeds 1 .. `runs` are off by.
struct OneRun {
  double cpu_s, square, samples;
};
ErrorPoint rms_point(unsigned runs, const std::function<OneRun(unsigned seed)>& run);

/// The square that work returns, and the time that it takes.
OneRun timed_run(double samples, const std::function<double()>& work);

}  // namespace flatspeckle::bench
