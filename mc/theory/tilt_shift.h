#pragma once

#include <vector>

#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

/// A half-width and its jackknife error.
struct RangeEstimate {
  Range range;
  double error = 0;
};

/// The field correlation of a tilt_shift request (C19): on the map, and for far views with the
/// views matched to each tilt. Half-widths along tilts at shift 0 and along matched views, in
/// tilt_q; along shifts at tilt 0.
struct TiltShift {
  std::vector<double> correlation, correlation_error;  ///< [tilt][shift]
  std::vector<double> matched, matched_error;          ///< [tilt]; empty for near sensors
  RangeEstimate along_tilts, along_shifts, along_matched;
};

TiltShift tilt_shift(const CovarianceRequest& request, const GroupedSums& sums,
                     const Estimator& covariance);

}  // namespace flatspeckle::mc
