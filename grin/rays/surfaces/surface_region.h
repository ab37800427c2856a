#pragma once

#include <algorithm>
#include <span>

#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// The region inside the first of several surfaces and outside all other surfaces. distance() and
/// normal() have the same meaning as for a surface.
struct SurfaceRegion {
  std::span<const Surface> surfaces;

  double distance(const Vec3& x) const {
    double most = grin::distance(surfaces[0], x);
    for (const Surface& hole : surfaces.subspan(1)) most = std::max(most, -grin::distance(hole, x));
    return most;
  }
  /// Whether a straight line leaves the region only once.
  bool is_convex() const {
    return surfaces.size() == 1 &&
           (std::holds_alternative<Sphere>(surfaces[0]) ||
            std::holds_alternative<Plane>(surfaces[0]) || std::holds_alternative<Box>(surfaces[0]));
  }
  /// Returns the index of the surface that determines distance(x).
  std::size_t nearest(const Vec3& x) const {
    std::size_t nearest = 0;
    double most = grin::distance(surfaces[0], x);
    for (std::size_t i = 1; i < surfaces.size(); ++i) {
      const double beyond = -grin::distance(surfaces[i], x);
      if (beyond <= most) continue;
      most = beyond;
      nearest = i;
    }
    return nearest;
  }
  Vec3 normal(const Vec3& x) const {
    const std::size_t at = nearest(x);
    return at == 0 ? grin::normal(surfaces[0], x) : Vec3(-grin::normal(surfaces[at], x));
  }
};

}  // namespace flatspeckle::grin
