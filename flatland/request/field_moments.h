#pragma once

#include "core/numbers/statistics.h"
#include "core/run/runner.h"
#include "flatland/request/request.h"

namespace flatspeckle {

/// What either solver makes of a scene: batches for the runner, and how their sums are read.
/// Nothing else may know which of the two it was.
struct FieldJob {
  BatchJob batches;
  Estimator mean;        ///< mean scattered field per channel; empty where it is not defined
  Estimator covariance;  ///< per entry of the request
};

/// Mean field per channel and covariance per requested entry, with standard errors.
struct FieldMoments {
  Estimate mean;
  Estimate covariance;
  double samples = 0;
};

/// Of an estimator, as a batch job asks for it.
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
