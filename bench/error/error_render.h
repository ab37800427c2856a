#pragma once

#include <vector>

#include "bench/error/error_references.h"

namespace flatspeckle::bench {

/// Path tracing, light tracing, bidirectional path tracing and the photon map on a Luneburg ball, a
/// waveguide of ultrasound, a slab and a glass ball in fog. Part of the boundary is the lamp and
/// another part the detector, so that rays can hit both: then every method but the photon map,
/// which is biased, has finite variance. Where they cannot, path tracing has none: one curve shows
/// it. A Luneburg ball in the same light from everywhere is known in closed form, and so is a ring
/// of triangles; a ball of triangles is compared with the ball of its volume.
std::vector<ErrorRun> render_error_runs();
std::vector<LongRun> render_long_runs();

}  // namespace flatspeckle::bench
