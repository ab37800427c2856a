#pragma once

#include <variant>

#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

// How the normal of a surface turns along it: d normal / d x at a point on the surface, for
// displacements along it.

inline Mat3 curvature(const Sphere& sphere, const Vec3& x) {
  const Vec3 n = sphere.normal(x);
  return (Mat3::Identity() - n * n.transpose()) / sphere.radius;
}
inline Mat3 curvature(const Plane&, const Vec3&) {
  return Mat3::Zero();
}
inline Mat3 curvature(const Box&, const Vec3&) {
  return Mat3::Zero();
}
inline Mat3 curvature(const Lens& lens, const Vec3& x) {
  return lens.curvature(x);
}
inline Mat3 curvature(const LevelSurface& level, const Vec3& x) {
  return level.curvature(x);
}
inline Mat3 curvature(const Surface& surface, const Vec3& x) {
  return std::visit([&](const auto& s) { return curvature(s, x); }, surface);
}

}  // namespace flatspeckle::grin
