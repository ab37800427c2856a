#include "mc/estimators/covariance_estimator.h"

#include "core/numbers/blas.h"
#include "mc/estimators/path_fields.h"
#include "mc/estimators/path_job.h"
#include "mc/estimators/single_scattering.h"

namespace flatspeckle::mc {

namespace {

/// Gives the field of every channel to an accumulator.
template <typename Scattering, bool reversed, bool phases>
class FieldScorer {
 public:
  FieldScorer(const Scene& scene, const Scattering& scattering, Accumulator& accumulator)
      : fields_(scene, scattering), accumulator_(accumulator) {}

  void single(Vec2 x, double weight) { accumulator_.add(weight, fields_.single(x)); }
  void multiple(const Path<typename Scattering::Direction>& path) {
    accumulator_.add(path.weight, fields_.multiple(path));
  }

 private:
  PathFields<Scattering, reversed, phases> fields_;
  Accumulator& accumulator_;
};

struct CovarianceKind {
  using Sums = Accumulator&;
  static constexpr bool bent = true;

  NoTally tally(const Scene&) const { return {}; }

  template <bool reversed, bool phases, typename Scattering>
  auto scorer(const Scene& scene, const Scattering& scattering, Accumulator& accumulator) const {
    return FieldScorer<Scattering, reversed, phases>(scene, scattering, accumulator);
  }

  template <typename Scattering>
  std::vector<Complex> single(const Scene& scene, const Scattering& scattering) const {
    return single_scattering(scene, scattering);
  }
};

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
  return walks(CovarianceKind(), scene, plan, seed);
}

FieldJob covariance_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  const auto batches = path_batches(scene, plan, seed);
  const auto single = unsampled(CovarianceKind(), scene, plan);
  if (!plan.rank_k)
    return path_job(scene, plan, 1, single, into<EntryAccumulator>(scene.request, batches)).field;
  blas_single_thread();  // before threads compete for its memory
  return path_job(scene, plan, 1, single, into<RankKAccumulator>(scene.request, batches)).field;
}

}  // namespace flatspeckle::mc
