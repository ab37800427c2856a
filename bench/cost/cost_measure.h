#pragma once

#include <functional>
#include <string>

#include "bench/cost/cost_curve.h"

namespace flatspeckle::bench {

// The runs of cost_runs(), by room.

/// One realization of resonant points at fixed density, one light: dense and fast solver.
std::vector<CostRun> wave_cost_runs();
/// Monte Carlo: paths, and an error of 1 %, against optical depth; paths against channels (views x
/// lights), for intensities and for the full covariance. Pairs of paths of the bidirectional
/// renderer against optical depth.
std::vector<CostRun> transport_cost_runs();
/// A ray through a Luneburg lens against its steps, by each integrator; and the inverse of its
/// error at the focus.
std::vector<CostRun> ray_cost_runs();

/// A work whose size doubles from `smallest` to `largest`.
struct Scaling {
  std::string what, size_name;
  double smallest, largest;
  double expected;  ///< exponent
  /// Prepares the work of a size; what it returns is timed, and may be called again.
  std::function<std::function<void()>(double size)> work;
};

/// CPU seconds of each size, medians of rounds in turn; sizes that would not end in time are left
/// out. The exponent is that of the four largest.
CostCurve measure_cost(const Scaling& scaling, double cpu_seconds);

CostRun cost_run(const Scaling& scaling);

/// The exponent of the four largest sizes, its error from the scatter about the line.
void fit_exponent(CostCurve& curve);

}  // namespace flatspeckle::bench
