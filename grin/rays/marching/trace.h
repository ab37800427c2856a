#pragma once

#include <span>

#include "grin/rays/marching/stepper.h"
#include "grin/rays/marching/watch.h"
#include "grin/rays/surfaces/first_crossing.h"
#include "grin/rays/surfaces/straight_crossing.h"

namespace flatspeckle::grin {

/// Implements trace() for a homogeneous medium. Computes the distance to each surface and makes no
/// steps.
inline TraceEnd trace_straight(const Homogeneous& field, std::span<const Surface> surfaces,
                               const TraceLimits& limits, RayState& ray) {
  const Watch watch(surfaces, limits, ray);
  const Vec3 direction = ray.v.normalized();
  double ray_length = limits.max_arc_length;
  int surface = -1;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (limits.sides.ignores(i)) continue;
    const double here = watch.is_inside(i) ? exit_distance(surfaces[i], ray.x, direction)
                                           : entry_distance(surfaces[i], ray.x, direction);
    if (here >= ray_length) continue;
    ray_length = here;
    surface = static_cast<int>(i);
  }
  Leapfrog::step(field, ray, ray_length / (1 + field.n_excess));
  return {surface < 0 ? Stop::length : Stop::surface, surface, 0, 1};
}

namespace trace_parts {

/// Returns an upper bound of the arc length of a step, with a margin because the arc length of an
/// integrator is not exact. For a failed step, returns the margin times twice the arc length
/// expected from its start.
inline double longest_arc(const RayState& start, const RayState& end, double h) {
  constexpr double margin = 1.1;
  const double arc = end.arc_length - start.arc_length;
  return margin * (arc > 0 ? arc : 2 * start.v.norm() * h);
}

inline TraceEnd end_at(const Watch& watch, const RayState& ray, const TraceLimits& limits) {
  if (!(watch.clearance(ray) <= limits.tolerance)) return {Stop::lost};
  const int surface = watch.nearest(ray);
  return {surface < 0 ? Stop::length : Stop::surface, surface};
}

}  // namespace trace_parts

/// Traces a ray from its state to the first surface that it meets, or to its largest arc length.
/// Far from all surfaces, crossings are not tested until the steps have covered the distance to the
/// nearest surface (sphere tracing). A step that may cross a surface is searched for its first
/// crossing, and the ray ends with the part of the step up to this crossing. Steps are defined in
/// grin/rays/marching/stepper.h.
template <class Steps, IndexField F>
TraceEnd trace(const F& field, std::span<const Surface> surfaces, const TraceLimits& limits,
               Steps& steps, RayState& ray) {
  if constexpr (HomogeneousField<F>) return trace_straight(field, surfaces, limits, ray);
  const Watch watch(surfaces, limits, ray);
  double clearance = watch.clearance(ray);
  TraceEnd end{Stop::steps, -1, 0, 1};
  while (end.steps < limits.max_steps) {
    ++end.steps;
    const RayState start = ray;
    const double h = steps.advance(field, ray);
    const bool is_lost = !(ray.arc_length > start.arc_length);
    const double arc = trace_parts::longest_arc(start, ray, h);
    clearance -= arc;
    if (!is_lost && clearance > 0) continue;
    const auto at = [&](double theta) {
      RayState part = start;
      steps.step(field, theta * h, part);
      ++end.distance_evaluations;
      return watch.clearance(part);
    };
    clearance = at(1);
    const auto bracket = first_change(at, {0, 1, at(0), clearance}, arc);
    if (bracket) {
      const double theta = zero(at, *bracket, limits.tolerance / 4);
      ray = start;
      steps.step(field, theta * h, ray);
      const TraceEnd found = trace_parts::end_at(watch, ray, limits);
      if (found.surface >= 0)
        settle(surfaces[found.surface], watch.is_inside(found.surface), limits.tolerance, ray);
      return {found.stop, found.surface, end.steps, end.distance_evaluations};
    }
    if (is_lost) {
      end.stop = Stop::lost;
      return end;
    }
  }
  return end;
}

}  // namespace flatspeckle::grin
