#pragma once

#include "apps/moments_group.h"
#include "flatland/request/field_moments.h"

namespace flatspeckle::apps {

/// What memory_effect, tilt_shift and translation requests ask for: covariances of reference and
/// moved field, their intensities, the field correlation and its half-widths.
void write_moves(MomentsGroup& group, const FieldJob& job, const Scene& scene,
                 const GroupedSums& sums, const Estimate& covariance);

}  // namespace flatspeckle::apps
