#pragma once

#include <vector>

#include "bench/error/error_curve.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::bench {

/// g 0.8, optical depth 5, 1000 wavelengths deep; without views.
SceneSpec hg_slab();

/// A slab's memory effect over seven tilts in transmission, in the plane and in space, by transport
/// without chance and by paths, and its intensities for a phase function of two terms.
std::vector<ErrorRun> slab_error_runs();

}  // namespace flatspeckle::bench
