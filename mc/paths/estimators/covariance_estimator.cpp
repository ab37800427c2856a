#include "mc/paths/estimators/covariance_estimator.h"

#include "core/numbers/blas.h"
#include "mc/paths/estimators/path_fields.h"
#include "mc/paths/estimators/scored_paths.h"
#include "mc/paths/estimators/single_scattering.h"

namespace flatspeckle::mc {

namespace {

/// Gives the field of every channel to an accumulator.
class FieldScorer : public PathScorer {
 public:
  FieldScorer(const PathWalks& walks, Accumulator& accumulator)
      : fields_(walks, walks.scene(), walks.plan().phases || walks.plan().reversed),
        accumulator_(accumulator) {}

  void single(Vec2 x, double weight) override { accumulator_.add(weight, fields_.single(x)); }
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
  blas_single_thread();  // before threads compete for its memory
  return path_job(scene, plan, 1, single, into<RankKAccumulator>(scene.request, batches)).field;
}

}  // namespace flatspeckle::mc
