#pragma once

#include "core/numbers/statistics.h"
#include "grin/sensors/pixel_grid.h"

namespace flatspeckle::grin {

/// The errors of marked entries (Estimate::rare) of a picture [row][column][bin] become upper
/// bounds. Few contributions carry such an entry: its error is doubled, and is no less than what
/// contributions of the size that its neighbours have might have left out. Marked is also what no
/// path has lit, which is not known to be dark, and where marked neighbours have most of the light:
/// what those found by chance others may have missed.
void bound_errors(Estimate& picture, const PixelGrid& grid);

}  // namespace flatspeckle::grin
