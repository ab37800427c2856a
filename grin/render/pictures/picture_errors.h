#pragma once

#include "core/numbers/statistics.h"
#include "grin/render/sensors/pixel_grid.h"

namespace flatspeckle::grin {

/// Groups of 256 that make up an error; what fewer do is marked. Of light paths that are worth as
/// unequal as in a graded fibre, values of fewer lie beyond two errors too often.
inline constexpr double few_of_values = 36;
/// Where neighbours have a say in it (bound_errors).
inline constexpr double few_of_pixels = 12;

/// Marks (Estimate::rare) of a picture [row][column][bin] that each entry has by itself become
/// those of neighbourhoods, and errors of marked entries upper bounds. An entry is marked where
/// most of it and its neighbours are, or those that are have most of the light: by itself an entry
/// looks surest that strong paths have missed by chance. Marked is also what no path has lit, which
/// is not known to be dark. The error of a marked entry is doubled, and is no less than what
/// contributions of the size that its neighbours have might have left out.
void bound_errors(Estimate& picture, const PixelGrid& grid);

}  // namespace flatspeckle::grin
