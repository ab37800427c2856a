#pragma once

#include <vector>

#include "bench/error/error_references.h"

namespace flatspeckle::bench {

/// Covariance of speckle on box_points, box_points_absorbing and box_cylinders (data/scenes), as
/// memory effect over seven tilts in transmission and reflection: the exact ensemble by the dense
/// and by the fast solver, and the methods of paths.
std::vector<ErrorRun> box_error_runs();
std::vector<LongRun> box_long_runs();

}  // namespace flatspeckle::bench
