#pragma once

#include <filesystem>

#include "grin/fields/spline_field.h"
#include "grin/media/density_grid.h"

namespace flatspeckle::grin {

/// A grid of n - 1 from an HDF5 file: dataset "excess" with axes x, y, z, and on it the attributes
/// "origin" and "spacing", three numbers each. Throws InputError naming the file where something is
/// missing, of another shape, or not a field (SplineField says what is).
SplineField read_spline_field(const std::filesystem::path& path);

/// A relative density in the same form, dataset "density".
DensityGrid read_density_grid(const std::filesystem::path& path);

}  // namespace flatspeckle::grin
