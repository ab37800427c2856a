#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/path_job.h"
#include "mc/paths/walk/accumulator.h"
#include "mc/paths/walk/plan.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// How walks make estimates, per entry of the request: of the covariance, then of other quantities.
struct ScoredPaths {
  std::size_t quantities = 1;
  /// Makes a batch's scorer, which adds to zeroed sums, [quantity][entry].
  std::function<std::unique_ptr<PathScorer>(const PathWalks&, std::span<Complex> sums)> scorer;
  /// Those of paths of one scatterer in closed form, [quantity][entry]; none where walks always
  /// sample them.
  std::function<std::vector<Complex>(const PathWalks&)> single{};
};

/// Throws InputError where light is bent: only fields and covariances are estimated there. Throws
/// std::logic_error for a plan that leaves paths of one scatterer to a closed form that is missing.
PathJob path_job(const ScoredPaths& paths, const Scene& scene, const Plan& plan,
                 std::uint64_t seed);

/// single: empty where walks sample paths of one scatterer.
PathJob path_job(const Scene& scene, const Plan& plan, std::size_t quantities,
                 const std::vector<Complex>& single, const SummedBatches& batches);

/// The Monte Carlo estimator of a scene's covariance as numbered batches of light paths
/// (conventions, C13-C18). The covariance is absolute: that of C4 amplitudes for unit plane waves,
/// on a slab per unit illuminated length. The mean field is that of coherent_field.h.
using PathBatches = std::function<void(std::uint64_t number, Accumulator&)>;
/// Numbered batches of plan.paths_per_batch paths, handed to an accumulator.
PathBatches path_batches(const Scene& scene, const Plan& plan, std::uint64_t seed);

FieldJob covariance_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

}  // namespace flatspeckle::mc
