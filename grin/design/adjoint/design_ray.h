#pragma once

#include <cmath>

#include "grin/design/adjoint/ray_adjoint.h"
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

/// Where a ray begins, in which direction, and what ends it.
struct DesignRay {
  Vec3 start, direction;
  RayEnd end;
};

/// A ray's end: so many whole steps and a last one of its own length. Lost: it came to no end, or
/// where the index is not positive.
struct FollowedRay {
  RayState state;
  long steps = 0;
  double last = 0;
  bool lost = false;
};

/// Steps of length h (in sigma).
struct RayWalk {
  double h;
  long most_steps;
};

namespace walk_parts {

/// The length of a last step that comes to the end, by Newton's method from a step beyond it.
template <class Scheme, IndexField F>
double last_step(const F& field, const RayEnd& end, const RayState& before, double h) {
  double last = h;
  for (int i = 0; i < 20; ++i) {
    RayState at = before;
    step<Scheme>(field, at, last);
    const double change = beyond(end, at) / end_rate(field, end, at);
    last -= change;
    if (!(std::abs(change) > 1e-15 * h)) break;
  }
  return last;
}

}  // namespace walk_parts

template <class Scheme, IndexField F>
FollowedRay follow(const F& field, const DesignRay& ray, const RayWalk& walk) {
  FollowedRay followed{start_ray(field, ray.start, ray.direction)};
  RayState& state = followed.state;
  while (followed.steps < walk.most_steps) {
    const RayState before = state;
    step<Scheme>(field, state, walk.h);
    if (beyond(ray.end, state) < 0) {
      ++followed.steps;
      continue;
    }
    followed.last = walk_parts::last_step<Scheme>(field, ray.end, before, walk.h);
    state = before;
    step<Scheme>(field, state, followed.last);
    followed.lost = !(followed.last > 0 && followed.last <= walk.h * 1.001);
    return followed;
  }
  followed.lost = true;
  return followed;
}

/// Walks a ray back to its start and adds to the sums the derivatives by the coefficients of the K
/// numbers whose derivatives by the end are given. Returns the ray's start as it is found again.
template <class Scheme, int K, DesignedField F>
RayState pull_back(const F& field, const DesignRay& ray, const RayWalk& walk,
                   const FollowedRay& followed, RayAdjoint<K> adjoint, CoefficientSums<K>& sums) {
  RayState state = followed.state;
  RayState before = state;
  step<Scheme>(field, before, -followed.last);
  // the last step is as long as brings the ray to its end
  const RayRate rate = step_with_rate<Scheme>(field, before, followed.last);
  const EndSlope slope = end_slope(ray.end, state);
  const typename RayAdjoint<K>::Row later =
      (rate.x.transpose() * adjoint.x + rate.v.transpose() * adjoint.v +
       rate.arc_length * adjoint.arc_length + rate.optical_path * adjoint.optical_path) /
      (slope.x.dot(rate.x) + slope.v.dot(rate.v));
  adjoint.x -= slope.x * later;
  adjoint.v -= slope.v * later;
  step_back<Scheme>(field, state, adjoint, sums, followed.last);
  for (long i = 0; i < followed.steps; ++i) step_back<Scheme>(field, state, adjoint, sums, walk.h);
  // |v| = n at the start
  const auto at = look(field, ray.start);
  const Vec3 direction = ray.direction.normalized();
  for (int c = 0; c < K; ++c)
    add_derivative(field, at, direction.dot(adjoint.v.col(c)), Vec3::Zero().eval(),
                   [&](int r) { return sums.row(c, r); });
  return state;
}

}  // namespace flatspeckle::grin::design
