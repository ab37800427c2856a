#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Scene keys of the start points and directions of rays.
struct RayStartValues {
  std::string rays{}, light = "line";
  std::int64_t ray_count = 11;
  std::vector<double> origin{0, 0, 0}, direction{0, 0, 1}, across{1, 0, 0};
  double beam_radius = 1, half_angle = 0.1;
};

void add_keys(Keys& keys, RayStartValues& values);

struct RayStart {
  Vec3 x, direction;  ///< `direction` is a unit vector
};

/// Returns the starts of the rays of a light source, or reads starts from a file if the key `rays`
/// is given. Throws InputError.
std::vector<RayStart> make_ray_starts(const Keys& keys, const RayStartValues& values);

}  // namespace flatspeckle::grin
