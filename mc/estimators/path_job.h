#pragma once

#include <cstdint>
#include <vector>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/walk/walks.h"

namespace flatspeckle::mc {

/// What estimates a scene's covariance, and whatever else depends on the same paths: their
/// derivatives, their decay in time. Each is a kind (walks.h) that has besides
///   quantities()               per entry of the request: the covariance, then its own
///   single(scene, scattering)  those of paths of one scatterer, [quantity][entry], in closed form
struct PathJob {
  FieldJob field;           ///< the covariance, and the mean field where that has a closed form
  Estimator all;            ///< [quantity][entry] of all paths
  std::size_t entries = 0;  ///< of the request
};

/// single: empty where walks sample those paths too.
PathJob path_job(const Scene& scene, const Plan& plan, std::size_t quantities,
                 const std::vector<Complex>& single, const SummedBatches& batches);

/// The closed forms that a plan leaves to them.
template <typename Kind>
std::vector<Complex> unsampled(const Kind& kind, const Scene& scene, const Plan& plan) {
  std::vector<Complex> single;
  if (plan.sampled_single || scene.medium.mu_s == 0) return single;
  with_any_scattering(scene, plan.phase, [&]<typename Scattering>(const Scattering& scattering) {
    if constexpr (!varies<Scattering> && !bends<Scattering>)
      single = kind.single(scene, scattering);
  });
  return single;
}

/// Of a kind whose Sums are those of the job.
template <typename Kind>
PathJob path_job(const Kind& kind, const Scene& scene, const Plan& plan, std::uint64_t seed) {
  return path_job(scene, plan, kind.quantities(), unsampled(kind, scene, plan),
                  walks(kind, scene, plan, seed));
}

}  // namespace flatspeckle::mc
