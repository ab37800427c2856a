#pragma once

#include <span>
#include <string>
#include <vector>

#include "wave_solver/maps/field_map.h"
#include "wave_solver/solutions/space_solution.h"

namespace flatspeckle::wave {

/// Returns the total field at points in space, [light][point]: light and scattered waves outside
/// the scatterers, the transmitted wave in penetrable spheres, 0 in soft and hard spheres. At a
/// point scatterer it is the field that excites the scatterer (FieldMap). The waves of all
/// scatterers are summed directly. tolerance: accuracy of beams. Threaded.
std::vector<Complex> total_field(const SpaceSolution& solution, std::span<const Vec> points,
                                 double tolerance);

/// Returns, for each sphere, the point of the map in the plane of this y that is nearest to it, or
/// a point on its surface if the map touches the sphere (map_sensors()).
std::vector<Vec> map_sensors(const MapGrid& grid, double y, const Placement& placement);

/// Writes a map of the total field in the plane of this y, as write_map() of a WaveSolution, and
/// returns a description of the method.
std::string write_map(ResultFile& file, const SpaceSolution& solution, const MapGrid& grid,
                      double y, double tolerance);

}  // namespace flatspeckle::wave
