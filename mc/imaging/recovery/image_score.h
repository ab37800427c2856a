#pragma once

#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// How well one object is another, at the best shift and, as an autocorrelation leaves open,
/// mirrored or not.
struct ImageScore {
  double found = 0;  ///< share of the true points that have one of the found within resolution
  double correlation = 0;  ///< of the brightness of those pairs, about 0: 1 for the same shares
};

/// Whether what is found may be the mirror image.
enum class MirrorImage { perhaps, no };

ImageScore score(const LineObject& truth, const LineObject& found, double resolution,
                 MirrorImage mirror = MirrorImage::perhaps);

}  // namespace flatspeckle::mc
