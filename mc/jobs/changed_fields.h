#pragma once

#include "mc/jobs/path_job.h"

namespace flatspeckle::mc {

/// How a field differs from another besides its light and view.
struct FieldChange {
  double delay = 0;  ///< k^2 D tau: recorded later, as the scatterers diffuse (brownian.h)
  /// Of its wavenumber, relative; its view is turned so that transverse momenta match. Attenuation
  /// and scattering stay those of k.
  double shift = 0;
};

/// Of a job whose quantities are the covariance, then the same where the second field of each entry
/// has changed. Of a request for intensities, [change][channel]: the covariances, and those over
/// the intensity without change, 0 where there is none. Of one for a memory effect: the covariances
/// of the reference with the tilted and changed field, [change][tilt][view], and C_E,
/// [change][tilt] (C19). magnitude: |correlation|, with the error of the modulus alone.
struct ChangeEstimates {
  Estimate covariance, correlation, magnitude;
};
ChangeEstimates change_estimates(const CovarianceRequest& request, const PathJob& job,
                                 const GroupedSums& sums);

}  // namespace flatspeckle::mc
