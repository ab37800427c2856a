#pragma once

#include <functional>
#include <vector>

#include "grin/media/geometry/vector_values.h"
#include "grin/render/endpoints/boundary_patch.h"
#include "grin/render/endpoints/path_end.h"

namespace flatspeckle::grin {

// The file of a kind of light declares: the light; its path endpoint, constructed from (light,
// stage, index), which throws InputError if the light does not fit the stage; and the values of its
// keys, with add_keys(keys, values) and make_lights(keys, values). The kind is listed in light.h.
//
// The endpoint has power(); sample(random), which returns a position; density(x), the density of
// this sample (per area; 1 for a point); sample_direction(at, random) and towards(at, direction),
// which return EndDirections; and by_index(at, direction), the EmissionChange of sampled light. An
// endpoint that can be hit also has contains(x) and inward(x) for points x on the boundary.

/// Index of refraction at a point, for the power of lights with a given L/n^2.
using IndexAt = std::function<double(const PathPoint&)>;

/// Derivatives of emitted light by ln n, with n the index where it starts, for fixed random
/// numbers.
struct EmissionChange {
  double weight = 0;              ///< derivative of the logarithm of the weight
  Vec3 direction = Vec3::Zero();  ///< derivative of the direction, perpendicular to the direction
};

}  // namespace flatspeckle::grin
