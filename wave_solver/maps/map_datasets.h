#pragma once

#include <optional>
#include <string>

#include "core/result/dataset_row.h"
#include "wave_solver/maps/field_map.h"

namespace flatspeckle::wave {

extern const DatasetTable map_table;

/// Writes total_field [light_angle, map_z, map_x] tile by tile, with progress on standard error,
/// and returns how it was summed; none where a signal came (catch_interrupts). The axis of lights
/// must have been written.
std::optional<std::string> write_map(ResultFile& file, const WaveSolution& solution,
                                     const MapGrid& grid, double tolerance);

}  // namespace flatspeckle::wave
