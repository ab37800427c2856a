#pragma once

#include <variant>

#include "grin/surfaces/signed_distance.h"

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

/// That of a distance grid is not continuous, and none is given.
inline bool has_curvature(const Surface& surface) {
  return !std::holds_alternative<DistanceGrid>(surface);
}
/// 0 where there is none.
inline Mat3 curvature(const Surface& surface, const Vec3& x) {
  if (const auto* sphere = std::get_if<Sphere>(&surface)) return curvature(*sphere, x);
  if (const auto* lens = std::get_if<Lens>(&surface)) return lens->curvature(x);
  return Mat3::Zero();
}

}  // namespace flatspeckle::grin
