#include "mc/estimators/path_job.h"

#include "mc/ends/coherent_field.h"

namespace flatspeckle::mc {

PathJob path_job(const Scene& scene, const Plan& plan, std::size_t quantities,
                 const std::vector<Complex>& single, const SummedBatches& batches) {
  const std::size_t entries = scene.request.entries.size();
  PathJob job;
  job.entries = entries;
  job.all = [single](double samples, std::span<const Complex> sums) {
    auto values = sample_mean(samples, sums);
    for (std::size_t i = 0; i < single.size(); ++i) values[i] += single[i];
    return values;
  };
  job.field.covariance = [all = job.all, entries](double samples, std::span<const Complex> sums) {
    auto values = all(samples, sums);
    values.resize(entries);
    return values;
  };
  if (has_coherent_field(scene))
    job.field.mean = [field = coherent_field(scene)](double, std::span<const Complex>) {
      return field;
    };
  job.field.batches = {quantities * entries, static_cast<double>(plan.paths_per_batch), batches,
                       relative_error_of(job.field.covariance)};
  return job;
}

}  // namespace flatspeckle::mc
