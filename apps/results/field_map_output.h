#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/keys/keys.h"
#include "wave_solver/maps/map_grid.h"

namespace flatspeckle::apps {

/// The map that solve is asked for.
struct MapSettings {
  std::vector<double> map;               ///< x0, x1, z0, z1; empty: none
  std::vector<std::int64_t> map_pixels;  ///< nx, nz; empty: ten per wavelength
};
void add_map_keys(Keys& keys, MapSettings& settings);

/// None where no map is asked for. Throws InputError.
std::optional<wave::MapGrid> map_grid(const Keys& keys, const MapSettings& settings,
                                      double wavelength);

}  // namespace flatspeckle::apps
