#pragma once

#include "mc/jobs/path_job.h"

namespace flatspeckle::mc {

/// Of a job whose quantities are the covariance, then the same where the second field of each entry
/// has changed. Of a request for intensities, [change][channel]: the covariances, and those over
/// the intensity without change, 0 where there is none. Of one for a memory effect: the covariances
/// of the reference with the tilted and changed field, [change][tilt][view], and C_E,
/// [change][tilt] (C19).
struct ChangeEstimates {
  Estimate covariance, correlation;
};
ChangeEstimates change_estimates(const CovarianceRequest& request, const PathJob& job,
                                 const GroupedSums& sums);

}  // namespace flatspeckle::mc
