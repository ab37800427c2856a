#include "mc/covariance_estimator.h"

#include <memory>
#include <type_traits>

#include "mc/accumulator.h"
#include "mc/coherent_field.h"
#include "mc/path_kernel.h"

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

using BatchFunction = std::function<void(std::uint64_t, std::span<Complex>)>;

template <typename Scattering, bool reversed, bool absorbing, bool near, typename Accumulator>
BatchFunction batch_function(std::shared_ptr<const Scene> scene, Scattering scattering,
                             std::uint64_t paths, std::uint64_t seed) {
  return [=](std::uint64_t number, std::span<Complex> sums) {
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), number);
    PathKernel<Scattering, reversed, absorbing, near> kernel(*scene, scattering);
    Accumulator accumulator(scene->request, sums);
    for (std::uint64_t path = 0; path < paths; ++path) kernel.walk(random, accumulator);
    accumulator.finish();
  };
}

template <typename Scattering>
BatchFunction specialise(const std::shared_ptr<const Scene>& scene, const Scattering& scattering,
                         const Plan& plan, std::uint64_t seed) {
  BatchFunction chosen;
  with_flag(plan.reversed, [&](auto reversed) {
    with_flag(plan.absorbing, [&](auto absorbing) {
      with_flag(plan.near, [&](auto near) {
        with_flag(plan.rank_k, [&](auto rank_k) {
          using Accumulator =
              std::conditional_t<decltype(rank_k)::value, RankKAccumulator, EntryAccumulator>;
          chosen = batch_function<Scattering, decltype(reversed)::value, decltype(absorbing)::value,
                                  decltype(near)::value, Accumulator>(scene, scattering,
                                                                      plan.paths_per_batch, seed);
        });
      });
    });
  });
  return chosen;
}

BatchFunction specialise(const std::shared_ptr<const Scene>& scene, const Plan& plan,
                         std::uint64_t seed) {
  if (scene->medium.mu_s == 0) return [](std::uint64_t, std::span<Complex>) {};
  switch (plan.phase) {
    case Plan::Phase::isotropic:
      return specialise(scene, IsotropicScattering{}, plan, seed);
    case Plan::Phase::henyey_greenstein:
      return specialise(scene, HenyeyGreensteinScattering{{scene->scatterer.g}}, plan, seed);
    case Plan::Phase::tabulated:
      break;
  }
  return specialise(scene, TabulatedScattering(scene->medium, scene->k), plan, seed);
}

}  // namespace

FieldJob covariance_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  const auto shared = std::make_shared<const Scene>(scene);
  FieldJob job;
  job.covariance = sample_mean;
  if (has_coherent_field(scene)) {
    job.mean = [field = coherent_field(scene)](double, std::span<const Complex>) { return field; };
  }
  job.batches.size = scene.request.entries.size();
  job.batches.samples_per_batch = static_cast<double>(plan.paths_per_batch);
  job.batches.run = specialise(shared, plan, seed);
  job.batches.relative_error = [covariance = job.covariance](const GroupedSums& sums) {
    return relative_error(jackknife(sums, covariance));
  };
  return job;
}

}  // namespace flatspeckle::mc
