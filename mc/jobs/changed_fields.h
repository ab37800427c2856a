#pragma once

#include "mc/jobs/path_job.h"

namespace flatspeckle::mc {

/// Difference of time or frequency between the two fields of a covariance entry, in addition to
/// their different lights and views.
struct FieldChange {
  /// k^2 D tau, if the second field is recorded a time tau later while the scatterers diffuse with
  /// the diffusion constant D (brownian.h).
  double delay = 0;
  /// Relative difference of the wavenumber of the second field from k. The view of the second field
  /// is turned so that transverse momenta match (conventions, C39). Attenuation and scattering keep
  /// their values at k.
  double shift = 0;
};

/// Estimates from a job whose first quantity is the covariance, followed by the covariance for each
/// change of the second field (delay or frequency shift). For an intensity request, `covariance` is
/// [change][channel], and `correlation` is the covariance divided by the intensity without change
/// (0 if that intensity is 0). For a memory-effect request, `covariance` is the covariance of the
/// reference with the tilted and changed field, [change][tilt][view], and `correlation` is C_E,
/// [change][tilt] (C19). `magnitude` is |correlation|; its error does not include the error of the
/// phase.
struct ChangeEstimates {
  Estimate covariance, correlation, magnitude;
};
ChangeEstimates change_estimates(const CovarianceRequest& request, const PathJob& job,
                                 const GroupedSums& sums);

}  // namespace flatspeckle::mc
