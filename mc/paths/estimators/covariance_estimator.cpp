#include "mc/paths/estimators/covariance_estimator.h"

#include <stdexcept>

#include "core/numbers/blas.h"
#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/coherent_field.h"
#include "mc/paths/estimators/path_fields.h"
#include "mc/paths/estimators/single_scattering.h"

namespace flatspeckle::mc {

PathJob path_job(const ScoredPaths& paths, const Scene& scene, const Plan& plan,
                 std::uint64_t seed) {
  refuse_graded(scene, "this; take covariances, fields or validate");
  const auto walks = path_walks(scene, plan, seed);
  const bool has_closed_form = paths.single && !scene.profile;
  if (!plan.sampled_single && !has_closed_form)
    throw std::logic_error("path_job: the plan requires a closed form for paths of one scatterer");
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
  job.field.batches.deterministic = scene.medium.mu_s == 0;
  return job;
}

namespace {

/// Passes the field of every channel to an accumulator.
class FieldScorer : public PathScorer {
 public:
  FieldScorer(const PathWalks& walks, Accumulator& accumulator)
      : fields_(walks, walks.scene(), walks.plan().phases || walks.plan().reversed),
        accumulator_(accumulator) {}

  void single(Vec x, double weight, FaceWaves waves) override {
    accumulator_.add(weight, fields_.single(x, waves));
  }
  void multiple(const Path& path) override {
    accumulator_.add(path.weight, fields_.multiple(path));
  }

 private:
  PathFields fields_;
  Accumulator& accumulator_;
};

PathBatches path_batches(const std::shared_ptr<const PathWalks>& walks) {
  return [walks](std::uint64_t number, Accumulator& accumulator) {
    if (!walks) return;
    FieldScorer scorer(*walks, accumulator);
    walks->batch(number, scorer);
  };
}

template <typename Entries>
auto into(const CovarianceRequest& request, const PathBatches& batches) {
  return [=](std::uint64_t number, std::span<Complex> sums) {
    Entries entries(request, sums);
    batches(number, entries);
    entries.finish();
  };
}

}  // namespace

PathBatches path_batches(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  return path_batches(path_walks(scene, plan, seed));
}

FieldJob covariance_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  const auto walks = path_walks(scene, plan, seed);
  const PathBatches batches = path_batches(walks);
  std::vector<Complex> single;
  if (walks && !plan.sampled_single && !scene.profile && !scene.index)
    single = single_scattering(scene, *walks);
  if (!plan.rank_k)
    return path_job(scene, plan, 1, single, into<EntryAccumulator>(scene.request, batches)).field;
  blas_single_thread();  // must come before several threads request memory from BLAS
  return path_job(scene, plan, 1, single, into<RankKAccumulator>(scene.request, batches)).field;
}

}  // namespace flatspeckle::mc
