#include "grin/rays/marching/watch.h"

#include <cmath>

#include "core/error.h"

namespace flatspeckle::grin {

Watch::Watch(std::span<const Surface> surfaces, const TraceLimits& limits, const RayState& start)
    : surfaces_(surfaces),
      tolerance_(limits.tolerance),
      last_arc_length_(start.arc_length + limits.max_arc_length) {
  if (surfaces.size() > max_surfaces) throw InputError("surfaces", surfaces.size(), "at most 64");
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const double d = distance(surfaces[i], start.x);
    const bool on_surface = std::abs(d) <= tolerance_;
    const bool inside = on_surface ? start.v.dot(normal(surfaces[i], start.x)) < 0 : d < 0;
    on_surface_ |= std::uint64_t{on_surface} << i;
    inside_ |= std::uint64_t{inside} << i;
  }
}

/// A surface that the ray starts on is put back by 3/4 of the tolerance, so that the ray is off it;
/// as rays end within the last quarter before a surface, they always end within the tolerance.
double Watch::clearance(std::size_t i, const Vec3& x) const {
  const double d = distance(surfaces_[i], x);
  return (is_inside(i) ? -d : d) + (on_surface_ >> i & 1 ? 0.75 * tolerance_ : 0);
}

double Watch::clearance(const RayState& ray) const {
  double least = last_arc_length_ - ray.arc_length;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const double here = clearance(i, ray.x);
    if (!(here >= least)) least = here;  // NaN stays
  }
  return least;
}

int Watch::nearest(const RayState& ray) const {
  double least = last_arc_length_ - ray.arc_length;
  int nearest = -1;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const double here = clearance(i, ray.x);
    if (here >= least) continue;
    least = here;
    nearest = static_cast<int>(i);
  }
  return nearest;
}

}  // namespace flatspeckle::grin
