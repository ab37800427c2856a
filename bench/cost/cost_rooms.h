#pragma once

#include <vector>

#include "bench/cost/cost_curve.h"

namespace flatspeckle::bench {

/// One realization of resonant points at fixed density, one light: dense and fast solver.
std::vector<CostRun> wave_cost_runs();
/// Monte Carlo: paths, and an error of 1 %, against optical depth; paths against channels (views x
/// lights), for intensities and for the full covariance. Pairs of paths of the bidirectional
/// renderer against optical depth.
std::vector<CostRun> transport_cost_runs();
/// A ray through a Luneburg lens against its steps, by each integrator; and the inverse of its
/// error at the focus.
std::vector<CostRun> ray_cost_runs();

}  // namespace flatspeckle::bench
