#pragma once

#include "core/numbers/statistics.h"
#include "core/run/runner.h"
#include "flatland/request/request.h"

namespace flatspeckle {

/// Computation of the mean field and the covariance of a scene, by the exact solver or by Monte
/// Carlo. The runner executes the batches, which add to sums; the estimators compute the results
/// from these sums. Code that runs the job does not depend on the solver.
struct FieldJob {
  BatchJob batches;
  /// Estimates the mean scattered field of each channel (light and view); empty if not computed.
  Estimator mean;
  Estimator covariance;  ///< estimates the covariance of each entry of the request
};

/// Mean field of each channel (light and view) and covariance of each requested entry, with
/// standard errors.
struct FieldMoments {
  Estimate mean;
  Estimate covariance;
  double samples = 0;
};

/// Returns the function that computes the relative error of an estimator, for
/// BatchJob::relative_error.
inline auto relative_error_of(const Estimator& estimator) {
  return
      [estimator](const GroupedSums& sums) { return relative_error(jackknife(sums, estimator)); };
}

inline FieldMoments field_moments(const FieldJob& job, const GroupedSums& sums) {
  FieldMoments moments;
  if (job.mean) moments.mean = jackknife(sums, job.mean);
  moments.covariance = jackknife(sums, job.covariance);
  moments.samples = sums.total_samples();
  return moments;
}

}  // namespace flatspeckle
