#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/error/error_curve.h"
#include "core/run/runner.h"

namespace flatspeckle::bench {

/// Run of a method with one seed: its batches, and the estimator that computes values from their
/// sums.
struct ErrorTrial {
  BatchJob batches;
  Estimator values;
};

struct ErrorMethod {
  std::string scene, name;
  std::function<ErrorTrial(std::uint64_t seed)> trial;
  std::uint64_t first_point = 1;  ///< number of batches at the first point of a curve
  bool is_monte_carlo = true;     ///< see ErrorCurve
  double share = 1;               ///< factor on the time budget; above 1 for expensive methods
  bool slow = false;              ///< see ErrorRun
};

/// Reference values with which an error curve is measured.
struct ErrorReference {
  std::vector<Complex> value;
  double relative_error = 0;  ///< RMS error over the entries, divided by the RMS of the values
  std::string how;            ///< origin of the values, in words
};

/// Returns the RMS error of `values` over the entries, divided by the RMS of the reference.
double relative_distance(const std::vector<Complex>& values, const ErrorReference& reference);

/// Measures a curve from runs with many seeds, each of the same number of batches, with a point at
/// each doubling of the batches. All points average over the same number of runs, so that the error
/// of a method with infinite variance decays more slowly. The slope is a least-squares fit weighted
/// by the points' errors. The error of the slope is from a jackknife over the runs and includes the
/// error of the reference.
ErrorCurve measure_error(const ErrorMethod& method, const ErrorReference& reference,
                         double cpu_seconds);

/// Returns the measurement of a method's error curve. The reference is computed only when the curve
/// is measured.
ErrorRun run_of(const ErrorMethod& method, const std::function<ErrorReference()>& reference);

/// Adds the points that `next` returns to a curve. Stops when the time is used up, `next` returns
/// nullopt, or a point's error is less than twice the error of the reference. The slope is from
/// unweighted least squares through all points, the efficiency from the last point.
void measure_points(ErrorCurve& curve, double cpu_seconds,
                    const std::function<std::optional<ErrorPoint>()>& next);

/// CPU time, squared error and number of samples of one run.
struct OneRun {
  double cpu_s, square, samples;
};
ErrorPoint rms_point(unsigned runs, const std::function<OneRun(unsigned seed)>& run);

/// Runs `work`, which returns the squared error, and measures its time.
OneRun timed_run(double samples, const std::function<double()>& work);

}  // namespace flatspeckle::bench
