#pragma once

#include <vector>

#include "bench/error/error_curve.h"

namespace flatspeckle::bench {

/// A slab's memory effect over seven tilts in transmission, in the plane and in space, by transport
/// without chance and by paths, and its intensities for a phase function of two terms.
std::vector<ErrorRun> slab_error_runs();

}  // namespace flatspeckle::bench
