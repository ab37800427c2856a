#include "mc/paths/estimators/scored_paths.h"

#include <stdexcept>

#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/coherent_field.h"

namespace flatspeckle::mc {

PathJob path_job(const ScoredPaths& paths, const Scene& scene, const Plan& plan,
                 std::uint64_t seed) {
  refuse_graded(scene, "this; take covariances, fields or validate");
  const auto walks = path_walks(scene, plan, seed);
  const bool has_closed_form = paths.single && !scene.profile;
  if (!plan.sampled_single && !has_closed_form)
    throw std::logic_error("a plan that leaves paths of one scatterer to a closed form: has none");
  return path_job(scene, plan, paths.quantities,
                  walks && !plan.sampled_single ? paths.single(*walks) : std::vector<Complex>(),
                  [walks, scorer = paths.scorer](std::uint64_t number, std::span<Complex> sums) {
                    if (walks) walks->batch(number, *scorer(*walks, sums));
                  });
}

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
