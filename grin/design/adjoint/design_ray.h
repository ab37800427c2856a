#pragma once

#include <cmath>

#include "grin/design/adjoint/ray_adjoint.h"
#include "grin/rays/marching/ray_step.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin::design {

/// End condition of a ray at a turning point, where its distance from the line through axis_point
/// along z is smallest. The ray must start at its largest distance from this line.
struct Turn {
  Vec3 axis_point;
};

/// Condition that ends a ray: a surface or a turning point. The ray ends where beyond(end, ray)
/// rises through 0.
using RayEnd = std::variant<Surface, Turn>;

/// Derivatives of beyond() with respect to the state (x, v) of the ray.
struct EndDerivative {
  Vec3 x, v;
};

namespace end_parts {

inline Vec3 across(const Vec3& x) {
  return {x[0], x[1], 0};
}

}  // namespace end_parts

/// Returns a number that rises through 0 where the ray ends: signed distance from the surface or,
/// for a turning point, the radial velocity.
inline double beyond(const RayEnd& end, const RayState& ray) {
  if (const auto* turn = std::get_if<Turn>(&end))
    return end_parts::across(ray.x - turn->axis_point).dot(ray.v);
  return distance(std::get<Surface>(end), ray.x);
}

inline EndDerivative end_derivative(const RayEnd& end, const RayState& ray) {
  if (const auto* turn = std::get_if<Turn>(&end))
    return {end_parts::across(ray.v), end_parts::across(ray.x - turn->axis_point)};
  return {normal(std::get<Surface>(end), ray.x), Vec3::Zero()};
}

/// Returns the derivative of beyond() with respect to the ray parameter sigma, where d(arc length)
/// = n d(sigma).
template <IndexField F>
double end_rate(const F& field, const RayEnd& end, const RayState& ray) {
  const EndDerivative derivative = end_derivative(end, ray);
  const double by_x = derivative.x.dot(ray.v);
  if (std::holds_alternative<Surface>(end)) return by_x;
  return by_x + derivative.v.dot(ray_force(field, ray.x).force);
}

/// Start, direction and end condition of a ray.
struct DesignRay {
  Vec3 start, direction;
  RayEnd end;
};

/// Result of tracing a ray to its end: it made `steps` steps of full length and a shorter one of
/// length `last`. The ray is lost if it does not reach its end or reaches a place where the index
/// is not positive.
struct FollowedRay {
  RayState state;
  long steps = 0;
  double last = 0;
  bool lost = false;
};

/// Length h of an integration step (in sigma, C23) and the largest number of steps of a ray.
struct RayWalk {
  double h;
  long most_steps;
};

namespace walk_parts {

/// Returns the length of the last step, at whose end beyond() is 0. Uses Newton's method, starting
/// with a step of full length.
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

/// Integrates a ray back to its start. `adjoint` contains the derivatives of K measurements with
/// respect to the state at the end of the ray. The derivatives of these measurements with respect
/// to the coefficients of the field are added to `sums`. Returns the recomputed start of the ray.
template <class Scheme, int K, DesignedField F>
RayState backpropagate(const F& field, const DesignRay& ray, const RayWalk& walk,
                       const FollowedRay& followed, RayAdjoint<K> adjoint,
                       CoefficientSums<K>& sums) {
  RayState state = followed.state;
  RayState before = state;
  step<Scheme>(field, before, -followed.last);
  // the end condition makes the length of the last step depend on the state
  const RayRate rate = step_with_rate<Scheme>(field, before, followed.last);
  const EndDerivative derivative = end_derivative(ray.end, state);
  const typename RayAdjoint<K>::Row later =
      (rate.x.transpose() * adjoint.x + rate.v.transpose() * adjoint.v +
       rate.arc_length * adjoint.arc_length + rate.optical_path * adjoint.optical_path) /
      (derivative.x.dot(rate.x) + derivative.v.dot(rate.v));
  adjoint.x -= derivative.x * later;
  adjoint.v -= derivative.v * later;
  step_back<Scheme>(field, state, adjoint, sums, followed.last);
  for (long i = 0; i < followed.steps; ++i) step_back<Scheme>(field, state, adjoint, sums, walk.h);
  // The start vector v depends on the coefficients because |v| = n
  const auto at = evaluate(field, ray.start);
  const Vec3 direction = ray.direction.normalized();
  for (int c = 0; c < K; ++c)
    add_derivative(field, at, direction.dot(adjoint.v.col(c)), Vec3::Zero().eval(),
                   [&](int r) { return sums.row(c, r); });
  return state;
}

}  // namespace flatspeckle::grin::design
