#include "mc/estimators/covariance_estimator.h"

#include <memory>

#include "mc/ends/coherent_field.h"
#include "mc/estimators/single_scattering.h"
#include "mc/walk/accumulator.h"
#include "mc/walk/path_fields.h"
#include "mc/walk/walk_setup.h"

namespace flatspeckle::mc {

namespace {

template <bool reversed, bool weighted, bool near, bool phases, typename Scattering>
PathBatches batches(const Scene& scene, const Plan& plan, const Scattering& scattering,
                    std::uint64_t seed) {
  using Shared = WalkSetup<Scattering, reversed, weighted>;
  const auto setup = std::make_shared<const Shared>(scene, plan, scattering);
  return [setup, seed](std::uint64_t number, Accumulator& accumulator) {
    PathFields<Scattering, reversed, near, phases> fields(setup->scene, setup->scattering,
                                                          accumulator);
    setup->walk_batch(seed, number, fields);
  };
}

template <typename Scattering>
PathBatches specialise(const Scene& scene, const Plan& plan, const Scattering& scattering,
                       std::uint64_t seed) {
  PathBatches chosen;
  with_flag(plan.weighted, [&](auto weighted) {
    with_flag(plan.near, [&](auto near) {
      constexpr bool w = decltype(weighted)::value, n = decltype(near)::value;
      if (plan.reversed)
        chosen = batches<true, w, n, true>(scene, plan, scattering, seed);
      else if (plan.phases)
        chosen = batches<false, w, n, true>(scene, plan, scattering, seed);
      else
        chosen = batches<false, w, n, false>(scene, plan, scattering, seed);
    });
  });
  return chosen;
}

/// Sampled paths, and those of one scatterer where no walk samples them.
Estimator covariance_of(const Scene& scene, const Plan& plan) {
  if (plan.sampled_single || scene.medium.mu_s == 0) return sample_mean;
  std::vector<Complex> single;
  with_scattering(scene, plan.phase,
                  [&](const auto& scattering) { single = single_scattering(scene, scattering); });
  return [single](double samples, std::span<const Complex> sums) {
    auto values = sample_mean(samples, sums);
    for (std::size_t e = 0; e < values.size(); ++e) values[e] += single[e];
    return values;
  };
}

SummedBatches listed_entries(const CovarianceRequest& request, const PathBatches& batches) {
  return [=](std::uint64_t number, std::span<Complex> sums) {
    EntryAccumulator accumulator(request, sums);
    batches(number, accumulator);
  };
}

SummedBatches whole_matrix(const CovarianceRequest& request, const PathBatches& batches) {
  return [=](std::uint64_t number, std::span<Complex> sums) {
    RankKAccumulator accumulator(request, sums);
    batches(number, accumulator);
    accumulator.finish();
  };
}

}  // namespace

PathBatches path_batches(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  if (scene.medium.mu_s == 0) return [](std::uint64_t, Accumulator&) {};
  PathBatches chosen;
  with_scattering(scene, plan.phase, [&](const auto& scattering) {
    chosen = specialise(scene, plan, scattering, seed);
  });
  return chosen;
}

FieldJob covariance_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  FieldJob job;
  job.covariance = covariance_of(scene, plan);
  if (has_coherent_field(scene)) {
    job.mean = [field = coherent_field(scene)](double, std::span<const Complex>) { return field; };
  }
  job.batches.size = scene.request.entries.size();
  job.batches.samples_per_batch = static_cast<double>(plan.paths_per_batch);
  const auto batches = path_batches(scene, plan, seed);
  job.batches.run =
      plan.rank_k ? whole_matrix(scene.request, batches) : listed_entries(scene.request, batches);
  job.batches.relative_error = [covariance = job.covariance](const GroupedSums& sums) {
    return relative_error(jackknife(sums, covariance));
  };
  return job;
}

}  // namespace flatspeckle::mc
