#include "grin/rays/marching/watch.h"

#include <cmath>

#include "core/error.h"
#include "grin/rays/surfaces/straight_crossing.h"

namespace flatspeckle::grin {

Watch::Watch(std::span<const Surface> surfaces, const TraceLimits& limits, const RayState& start)
    : surfaces_(surfaces),
      tolerance_(limits.tolerance),
      last_arc_length_(start.arc_length + limits.max_arc_length),
      known_(limits.sides) {
  if (surfaces.size() > max_surfaces)
    throw InputError("surfaces", surfaces.size(), "must be at most 64");
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const double d = distance(surfaces[i], start.x);
    const bool on_surface = std::abs(d) <= tolerance_;
    const bool inside = on_surface ? start.v.dot(normal(surfaces[i], start.x)) < 0 : d < 0;
    on_surface_ |= std::uint64_t{on_surface} << i;
    inside_ |= std::uint64_t{inside} << i;
  }
  inside_ = (inside_ | known_.inside) & ~known_.outside;
}

void settle(const Surface& surface, bool inside, double tolerance, RayState& ray) {
  const double off = distance(surface, ray.x), n = ray.v.norm(), most = 100 * tolerance;
  const bool is_beyond = (off < 0) != inside;
  const Vec3 towards = (is_beyond ? -1 : 1) / n * ray.v;
  const double ray_length =
      off < 0 ? exit_distance(surface, ray.x, towards) : entry_distance(surface, ray.x, towards);
  if (ray_length <= most) {
    ray.x += ray_length * towards;
    ray.accumulate(n, (is_beyond ? -ray_length : ray_length) / n);
  } else {  // a grazing ray is moved along the normal
    ray.x -= off * normal(surface, ray.x);
  }
}

/// If the ray starts on a surface, this surface counts as moved back by 3/4 of the tolerance, so
/// that the start is not on it. Rays end within 1/4 of the tolerance before a surface, so that they
/// always end within the tolerance of the true surface.
double Watch::clearance(std::size_t i, const Vec3& x) const {
  const double d = distance(surfaces_[i], x);
  return (is_inside(i) ? -d : d) + (on_surface_ >> i & 1 ? 0.75 * tolerance_ : 0);
}

double Watch::clearance(const RayState& ray) const {
  double least = last_arc_length_ - ray.arc_length;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    if (known_.ignores(i)) continue;
    const double here = clearance(i, ray.x);
    if (!(here >= least)) least = here;  // NaN is kept
  }
  return least;
}

/// A surface on which the ray starts counts as moved back (see clearance()) only if the ray leaves
/// it. If two surfaces are close to each other, the nearest is then the one that the ray meets
/// first.
int Watch::nearest(const RayState& ray) const {
  double least = last_arc_length_ - ray.arc_length;
  int nearest = -1;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    if (known_.ignores(i)) continue;
    const Surface& surface = surfaces_[i];
    const double away = is_inside(i) ? -distance(surface, ray.x) : distance(surface, ray.x);
    if (away >= least) continue;
    const bool nears = (ray.v.dot(normal(surface, ray.x)) > 0) == is_inside(i);
    const double here = nears ? away : clearance(i, ray.x);
    if (here >= least) continue;
    least = here;
    nearest = static_cast<int>(i);
  }
  return nearest;
}

}  // namespace flatspeckle::grin
