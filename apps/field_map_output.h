#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "core/result/result_file.h"
#include "wave_solver/maps/field_map.h"

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

/// Writes total_field [light_angle, map_z, map_x] tile by tile, with progress on standard error,
/// and returns how it was summed; none where a signal came (catch_interrupts).
std::optional<std::string> write_map(ResultFile& file, const wave::WaveSolution& solution,
                                     const wave::MapGrid& grid, double tolerance);

}  // namespace flatspeckle::apps
