#pragma once

#include "grin/rays/surfaces/level_grid.h"

namespace flatspeckle::grin {

/// As LevelSurface::way.
double way_to_level(const LevelGrid& grid, const Vec3& x, const Vec3& d, double side);

}  // namespace flatspeckle::grin
