#pragma once

#include <cstddef>
#include <vector>

#include "flatland/media/domain.h"

namespace flatspeckle::mc {

/// So many places along each side of a box, round about it; each side begins at a corner.
inline std::vector<Vec2> edge_places(const Domain& box, std::size_t per_side) {
  const double half = box.width / 2;
  const Vec2 corners[] = {{-half, 0}, {half, 0}, {half, box.depth}, {-half, box.depth}};
  std::vector<Vec2> places;
  for (std::size_t side = 0; side < 4; ++side)
    for (std::size_t i = 0; i < per_side; ++i) {
      const Vec2 from = corners[side], to = corners[(side + 1) % 4];
      places.push_back(from + static_cast<double>(i) / static_cast<double>(per_side) * (to - from));
    }
  return places;
}

}  // namespace flatspeckle::mc
