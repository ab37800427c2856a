#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/result/result_file.h"
#include "wave_solver/maps/field_map.h"
#include "wave_solver/periodic/scattering_matrix.h"

namespace flatspeckle::wave {

/// Writes maps of the total field of a periodic cell, total_field [map_wave, map_z, map_x], and
/// returns FieldMap::method(). Lights from the front, with unit power flux through a period divided
/// by the period: the channel that is closest to normal incidence, then the transmission
/// eigenchannels of these numbers, of which 0 is the most open. placement: lies in the region of
/// the images, which also contains the map. found: its scattering matrix.
std::string write_cell_map(ResultFile& file, const Placement& placement, double k,
                           const CellImages& images, const ScatteringMatrix& found,
                           std::span<const std::int64_t> numbers, const SolveOptions& options,
                           const MapGrid& grid);

}  // namespace flatspeckle::wave
