#pragma once

#include "core/numbers/statistics.h"
#include "grin/render/sensors/pixel_grid.h"

namespace flatspeckle::grin {

/// An error is undersampled (Estimate::rare) if fewer than this effective number of the 256 groups
/// contribute to it. With path weights as unequal as in a graded fibre, values from fewer groups
/// deviate by more than two errors too often.
inline constexpr double few_of_values = 36;
/// Returns the corresponding number for pixels of pictures, whose neighbours are considered as well
/// (bound_errors): 12. jackknife() reduces it in proportion if there are few groups; for those it
/// is raised, so that pixels in whose paths one or two events differ from all others are
/// undersampled.
double few_of_pixels(std::size_t groups);

/// Recomputes the undersampled flags (Estimate::rare) of a picture [row][column][bin] from
/// neighbourhoods, and replaces the errors of undersampled entries by upper bounds. An entry is
/// undersampled in these cases:
/// - Its error exceeds 40 %.
/// - It is flagged, and one missed contribution as large as those around it would exceed its error.
/// - Entries that are flagged or have errors above 40 % are more than half of those with light
///   around it, or have more than half of the light there. Its own flag does not suffice, since an
///   entry that paths of high weight have missed by chance has a small error.
/// - Entries that are flagged are more than an eighth of those with light around it, and its error
/// is
///   less than half of the RMS error there: the rare events of its neighbours may have missed it.
/// - No path has hit it, but there is light around it.
/// The error of an undersampled entry is doubled, but is at least the bound for missed
/// contributions that are as large as those around it and, after missed events, the RMS error
/// there. Entries without light around them are dark:
/// their error is the bound for contributions as large as those of the whole picture.
void bound_errors(Estimate& picture, const PixelGrid& grid);

}  // namespace flatspeckle::grin
