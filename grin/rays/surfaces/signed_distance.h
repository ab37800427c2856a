#pragma once

#include <variant>

#include "grin/media/geometry/shapes.h"
#include "grin/rays/surfaces/lens.h"
#include "grin/rays/surfaces/level_surface.h"

namespace flatspeckle::grin {

/// A surface is where distance(x) is 0; it is negative inside. |distance| is nowhere more than the
/// true distance, so that a ray may go that far without looking. normal(x) is a unit vector
/// outwards, meant for points on the surface.
using Surface = std::variant<Sphere, Plane, Box, Lens, LevelSurface>;

inline double distance(const Surface& surface, const Vec3& x) {
  return std::visit([&](const auto& s) { return s.distance(x); }, surface);
}
inline Vec3 normal(const Surface& surface, const Vec3& x) {
  return std::visit([&](const auto& s) { return s.normal(x); }, surface);
}

}  // namespace flatspeckle::grin
