#include "mc/covariance_estimator.h"

#include <memory>
#include <type_traits>

#include "mc/accumulator.h"
#include "mc/coherent_field.h"
#include "mc/path_fields.h"
#include "mc/path_walk.h"
#include "mc/single_scattering.h"

namespace flatspeckle::mc {

namespace {

/// Calls f with std::true_type or std::false_type.
template <typename F>
void with_flag(bool flag, F f) {
  if (flag)
    f(std::true_type{});
  else
    f(std::false_type{});
}

/// What all batches share.
template <typename Scattering, bool reversed, bool weighted>
struct Setup {
  Setup(const Scene& its_scene, const Plan& its_plan, const Scattering& its_scattering)
      : scene(its_scene),
        plan(its_plan),
        scattering(its_scattering),
        walk(scene, plan, scattering) {}
  Setup(const Setup&) = delete;

  const Scene scene;
  const Plan plan;
  const Scattering scattering;
  const PathWalk<Scattering, reversed, weighted> walk;
};

template <bool reversed, bool weighted, bool near, bool phases, typename Scattering>
PathBatches batches(const Scene& scene, const Plan& plan, const Scattering& scattering,
                    std::uint64_t seed) {
  using Shared = Setup<Scattering, reversed, weighted>;
  const auto setup = std::make_shared<const Shared>(scene, plan, scattering);
  return [setup, seed](std::uint64_t number, Accumulator& accumulator) {
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), number);
    auto walk = setup->walk;
    PathFields<Scattering, reversed, near, phases> fields(setup->scene, setup->scattering,
                                                          accumulator);
    walk.begin(random);
    for (std::uint64_t path = 0; path < setup->plan.paths_per_batch; ++path)
      walk.walk(random, fields);
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

template <typename F>
void with_scattering(const Scene& scene, const Plan& plan, F f) {
  switch (plan.phase) {
    case Plan::Phase::isotropic:
      return f(IsotropicScattering{});
    case Plan::Phase::henyey_greenstein:
      return f(HenyeyGreensteinScattering{{scene.scatterer.g}});
    case Plan::Phase::tabulated:
      return f(TabulatedScattering(scene.medium, scene.k));
  }
}

/// Sampled paths, and those of one scatterer where no walk samples them.
Estimator covariance_of(const Scene& scene, const Plan& plan) {
  if (plan.sampled_single || scene.medium.mu_s == 0) return sample_mean;
  std::vector<Complex> single;
  with_scattering(scene, plan, [&](const auto& scattering) {
    single = single_scattering(scene, scattering);
  });
  return [single](double samples, std::span<const Complex> sums) {
    auto values = sample_mean(samples, sums);
    for (std::size_t e = 0; e < values.size(); ++e) values[e] += single[e];
    return values;
  };
}

template <typename A>
std::function<void(std::uint64_t, std::span<Complex>)> accumulated(
    const PathBatches& batches, const CovarianceRequest& request) {
  return [batches, request](std::uint64_t number, std::span<Complex> sums) {
    A accumulator(request, sums);
    batches(number, accumulator);
    accumulator.finish();
  };
}

}  // namespace

PathBatches path_batches(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  if (scene.medium.mu_s == 0) return [](std::uint64_t, Accumulator&) {};
  PathBatches chosen;
  with_scattering(scene, plan, [&](const auto& scattering) {
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
  job.batches.run = plan.rank_k ? accumulated<RankKAccumulator>(batches, scene.request)
                                : accumulated<EntryAccumulator>(batches, scene.request);
  job.batches.relative_error = [covariance = job.covariance](const GroupedSums& sums) {
    return relative_error(jackknife(sums, covariance));
  };
  return job;
}

}  // namespace flatspeckle::mc
