#pragma once

#include <functional>
#include <string>

#include "bench/cost/cost_curve.h"

namespace flatspeckle::bench {

// The measurements of cost_runs(), by module.

/// Cost of solving one realization of resonant points at fixed density under one illumination, with
/// the dense and with the fast solver.
std::vector<CostRun> wave_cost_runs();
/// Cost of Monte Carlo paths, and of an error of 1 %, against optical depth. Cost of paths against
/// the number of channels (detection directions x illuminations), for intensities and for the full
/// covariance. Cost of path pairs in the bidirectional renderer against optical depth.
std::vector<CostRun> transport_cost_runs();
/// Cost of a ray through a Luneburg lens against its number of steps, for each integrator, and 1 /
/// (its error at the focus) against the same number.
std::vector<CostRun> ray_cost_runs();

/// A task whose size doubles from `smallest` to `largest`.
struct Scaling {
  std::string what, size_name;
  double smallest, largest;
  double expected;  ///< expected exponent
  /// Prepares the task of a given size. The returned function is timed and may be called
  /// repeatedly.
  std::function<std::function<void()>(double size)> work;
};

/// Measures the CPU seconds for each size, as medians over rounds that each run all sizes. Sizes
/// that would exceed the time budget are omitted. The exponent is fitted to the four largest.
CostCurve measure_cost(const Scaling& scaling, double cpu_seconds);

CostRun cost_run(const Scaling& scaling);

/// Fits the exponent to the four largest sizes; its standard error is from the scatter about the
/// line.
void fit_exponent(CostCurve& curve);

}  // namespace flatspeckle::bench
