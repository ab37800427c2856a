#pragma once

#include <span>

#include "grin/surfaces/signed_distance.h"

namespace flatspeckle::grin {

/// The region on one side of each surface.
struct Sides {
  std::span<const Surface> surfaces;
  std::span<const double> signs;  ///< 1: inside, -1: outside
  double tolerance = 0;           ///< so far beyond a surface is still on its side

  bool operator()(const Vec3& x) const {
    for (std::size_t i = 0; i < surfaces.size(); ++i)
      if (!(signs[i] * distance(surfaces[i], x) <= tolerance)) return false;
    return true;
  }
};

}  // namespace flatspeckle::grin
