#pragma once

#include "grin/rays/marching/ray_step.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin::design {

/// Where a ray is nearest to the line through a point along z, or farthest from it: of a ray that
/// starts where it is farthest, the nearest place is its end.
struct Turn {
  Vec3 axis_point;
};

/// What ends a ray: it is there where this rises through 0.
using RayEnd = std::variant<Surface, Turn>;

/// The derivatives of that by the ray.
struct EndSlope {
  Vec3 x, v;
};

namespace end_parts {

inline Vec3 across(const Vec3& x) {
  return {x[0], x[1], 0};
}

}  // namespace end_parts

inline double beyond(const RayEnd& end, const RayState& ray) {
  if (const auto* turn = std::get_if<Turn>(&end))
    return end_parts::across(ray.x - turn->axis_point).dot(ray.v);
  return distance(std::get<Surface>(end), ray.x);
}

inline EndSlope end_slope(const RayEnd& end, const RayState& ray) {
  if (const auto* turn = std::get_if<Turn>(&end))
    return {end_parts::across(ray.v), end_parts::across(ray.x - turn->axis_point)};
  return {normal(std::get<Surface>(end), ray.x), Vec3::Zero()};
}

/// By how much it rises in sigma.
template <IndexField F>
double end_rate(const F& field, const RayEnd& end, const RayState& ray) {
  const EndSlope slope = end_slope(end, ray);
  const double by_x = slope.x.dot(ray.v);
  if (std::holds_alternative<Surface>(end)) return by_x;
  return by_x + slope.v.dot(ray_force(field, ray.x).force);
}

}  // namespace flatspeckle::grin::design
