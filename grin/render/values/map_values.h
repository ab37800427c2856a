#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/keys/keys.h"
#include "grin/media/geometry/shapes.h"
#include "grin/render/methods/light_map.h"

namespace flatspeckle::grin {

/// Values of the keys of a map of fluence rate and absorbed power.
struct MapValues {
  std::vector<double> map_box{}, map_cylinder{};
  std::vector<std::int64_t> map_cells{};
};

void add_keys(Keys& keys, MapValues& values);

/// Makes the map, if keys give one. Throws InputError, also if it is outside of the stage.
std::optional<LightMap> light_map(const Keys& keys, const MapValues& values, const Box& stage);

}  // namespace flatspeckle::grin
