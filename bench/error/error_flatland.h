#pragma once

#include <vector>

#include "bench/error/error_references.h"

namespace flatspeckle::bench {

/// Covariance of speckle on box_points, box_points_absorbing, box_cylinders and slab_hg
/// (data/scenes), as memory effect over seven tilts in transmission and reflection: the exact
/// ensemble by the dense and by the fast solver, the published Monte Carlo estimator, ours, and
/// covariances taken from drawn speckle fields.
std::vector<ErrorRun> flatland_error_runs();
std::vector<LongRun> flatland_long_runs();

}  // namespace flatspeckle::bench
