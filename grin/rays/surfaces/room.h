#pragma once

#include <algorithm>
#include <span>

#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// The inside of the first of some surfaces, but for the insides of the others. distance() and
/// normal() as of a surface.
struct Room {
  std::span<const Surface> surfaces;

  double distance(const Vec3& x) const {
    double most = grin::distance(surfaces[0], x);
    for (const Surface& hole : surfaces.subspan(1)) most = std::max(most, -grin::distance(hole, x));
    return most;
  }
  /// A chord leaves it once.
  bool is_convex() const {
    return surfaces.size() == 1 && !std::holds_alternative<Lens>(surfaces[0]) &&
           !std::holds_alternative<LevelSurface>(surfaces[0]);
  }
  /// The number of the surface that is the way out at x.
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
