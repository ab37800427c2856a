#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result/result_file.h"
#include "wave_solver/maps/field_map.h"
#include "wave_solver/periodic/scattering_matrix.h"

namespace flatspeckle::wave {

/// Lights from the front of a periodic cell, beside the channel that is closest to normal
/// incidence.
struct CellLights {
  std::vector<std::int64_t> eigenchannels;  ///< numbers of eigenchannels; 0 is the most open
  std::vector<std::vector<Complex>> own;    ///< [light][channel], amplitudes with unit flux
};
/// Makes the lights. file: a table with columns light, channel, re and im, or empty; channels that
/// it does not name have the amplitude 0. channels: number of channels. Throws InputError.
CellLights cell_lights(std::vector<std::int64_t> eigenchannels, const std::string& file,
                       std::size_t channels);

/// Writes maps of the total field of a periodic cell, total_field [map_wave, map_z, map_x], and
/// returns FieldMap::method(). The channel closest to normal incidence and the eigenchannels have
/// unit power flux through a period divided by the period. placement: lies in the region of the
/// images, which also contains the map. found: its scattering matrix.
std::string write_cell_map(ResultFile& file, const Placement& placement, double k,
                           const CellImages& images, const ScatteringMatrix& found,
                           const CellLights& lights, const SolveOptions& options,
                           const MapGrid& grid);

}  // namespace flatspeckle::wave
