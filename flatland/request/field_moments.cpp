#include "flatland/request/field_moments.h"

namespace flatspeckle {

FieldMoments field_moments(const FieldJob& job, const GroupedSums& sums) {
  FieldMoments moments;
  if (job.mean) moments.mean = jackknife(sums, job.mean);
  moments.covariance = jackknife(sums, job.covariance);
  moments.samples = sums.total_samples();
  return moments;
}

}  // namespace flatspeckle
