#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/keys/keys.h"
#include "wave_solver/maps/field_map.h"

namespace flatspeckle::apps {

/// Values of the keys of the field map: the field on a grid of points.
struct MapSettings {
  std::vector<double> map;  ///< bounds of the map: x0, x1, z0, z1; empty if there is no map
  /// Numbers of pixels nx, nz; if empty, ten pixels per wavelength.
  std::vector<std::int64_t> map_pixels;
  std::optional<double> map_y;  ///< y of the plane of the map, in space
};
void add_map_keys(Keys& keys, MapSettings& settings);

/// Returns the grid of the field map; nullopt if no map is requested. Throws InputError.
std::optional<wave::MapGrid> map_grid(const Keys& keys, const MapSettings& settings,
                                      double wavelength);

}  // namespace flatspeckle::apps
