#pragma once

#include "mc/recovery/line_object.h"

namespace flatspeckle::mc {

/// How well one object is another, at the best shift, mirrored or not: what an autocorrelation
/// leaves open.
struct ImageScore {
  double found = 0;  ///< share of the true points that have one of the found within resolution
  double correlation = 0;  ///< of the brightness of those pairs, about 0: 1 for the same shares
};

ImageScore score(const LineObject& truth, const LineObject& found, double resolution);

}  // namespace flatspeckle::mc
