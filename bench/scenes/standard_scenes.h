#pragma once

#include <string>
#include <vector>

#include "flatland/scene/scene.h"

namespace flatspeckle::bench {

/// A standard scene (data/scenes) as memory effect over 64 tilts that reach beyond its range.
struct StandardScene {
  std::string name;
  Scene scene;
  bool reversed;  ///< counts reversed paths
};

/// box_points and box_cylinders in transmission (views 0.1 and 0.8) and in reflection with reversed
/// paths (pi and pi - 0.3), slab_hg at optical depth 10 with g = 0 and 0.9 along the normal.
std::vector<StandardScene> standard_scenes();
/// box_points_absorbing (albedo 0.8) and slab_hg at optical depth 10 with albedo 0.9, all in
/// transmission: where paths lose weight.
std::vector<StandardScene> absorbing_scenes();

}  // namespace flatspeckle::bench
