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

template <typename Scattering, bool reversed, bool absorbing, bool near>
PathBatches batches(std::shared_ptr<const Scene> scene, Scattering scattering, std::uint64_t paths,
                    std::uint64_t seed) {
  return [=](std::uint64_t number, Accumulator& accumulator) {
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), number);
    PathKernel<Scattering, reversed, absorbing, near> kernel(*scene, scattering);
    for (std::uint64_t path = 0; path < paths; ++path) kernel.walk(random, accumulator);
  };
}

template <typename Scattering>
PathBatches specialise(const std::shared_ptr<const Scene>& scene, const Scattering& scattering,
                       const Plan& plan, std::uint64_t seed) {
  PathBatches chosen;
  with_flag(plan.reversed, [&](auto reversed) {
    with_flag(plan.absorbing, [&](auto absorbing) {
      with_flag(plan.near, [&](auto near) {
        chosen = batches<Scattering, decltype(reversed)::value, decltype(absorbing)::value,
                         decltype(near)::value>(scene, scattering, plan.paths_per_batch, seed);
      });
    });
  });
  return chosen;
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

PathBatches path_batches(const Scene& original, const Plan& plan, std::uint64_t seed) {
  const auto scene = std::make_shared<const Scene>(original);
  if (scene->medium.mu_s == 0) return [](std::uint64_t, Accumulator&) {};
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

FieldJob covariance_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  FieldJob job;
  job.covariance = sample_mean;
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
