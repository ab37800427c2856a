#pragma once

#include <functional>
#include <vector>

#include "grin/media/geometry/vector_values.h"
#include "grin/render/endpoints/boundary_patch.h"
#include "grin/render/endpoints/path_end.h"

namespace flatspeckle::grin {

// A kind of light is a file with: the light; an end of paths made of (light, stage, index), which
// throws InputError where it does not fit the stage; its values, add_keys(keys, values) and
// make_lights(keys, values). It is listed in light.h.
//
// The end tells power(), draws sample(random) and tells density(x) of what it draws (per area; 1 of
// a point), and has sample_direction(at, random) and towards(at, direction) as EndDirections, and
// by_index(at, direction) of what it samples; what can be hit has contains(x) and inward(x) of
// points on the boundary.

/// Of refraction, for the power of what shines with a given L/n^2.
using IndexAt = std::function<double(const PathPoint&)>;

/// How light that is emitted by the same random numbers changes with ln n where it begins.
struct EmissionChange {
  double weight = 0;              ///< its logarithm
  Vec3 direction = Vec3::Zero();  ///< across the direction
};

}  // namespace flatspeckle::grin
