#pragma once

#include <variant>

#include "core/error.h"
#include "grin/media/geometry/shapes.h"
#include "grin/rays/surfaces/aspheric_lens.h"
#include "grin/rays/surfaces/lens.h"
#include "grin/rays/surfaces/level_surface.h"
#include "grin/rays/surfaces/turned_shape.h"

namespace flatspeckle::grin {

/// A surface. distance(x) is 0 on the surface and negative inside. |distance| never exceeds the
/// true distance, so that a ray may go as far as |distance| without a test for a crossing.
/// normal(x) is the outward unit vector at a point on the surface.
using Surface = std::variant<Sphere, Plane, Box, Lens, LevelSurface, AsphericLens, TurnedShape>;

inline double distance(const Surface& surface, const Vec3& x) {
  return std::visit([&](const auto& s) { return s.distance(x); }, surface);
}
inline Vec3 normal(const Surface& surface, const Vec3& x) {
  return std::visit([&](const auto& s) { return s.normal(x); }, surface);
}
/// Returns the box around a closed surface. Throws InputError for a plane.
inline Box bounds(const Surface& surface) {
  return std::visit(
      [](const auto& s) -> Box {
        if constexpr (requires { s.bounds(); }) return s.bounds();
        throw InputError("a plane cannot be the boundary of a stage or body: it is not closed");
      },
      surface);
}

}  // namespace flatspeckle::grin
