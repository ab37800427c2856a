#pragma once

#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// Agreement of a found object with the true one, at the best shift. The mirror image of the found
/// object may be used instead, because an autocorrelation does not distinguish the two.
struct ImageScore {
  double found = 0;  ///< fraction of the true points that have a found point within the resolution
  double correlation = 0;  ///< sum of products of the true and the found brightness over matched
                           ///< points, normalised to 1 if they are proportional
};

/// Whether the found object may be a mirror image of the true one.
enum class MirrorImage { perhaps, no };

ImageScore score(const LineObject& truth, const LineObject& found, double resolution,
                 MirrorImage mirror = MirrorImage::perhaps);

}  // namespace flatspeckle::mc
