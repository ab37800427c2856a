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

/// Quantities that walks estimate for every entry of the request. The first one is the covariance.
struct ScoredPaths {
  std::size_t quantities = 1;
  /// Makes the scorer of a batch. It adds its results to the sums, [quantity][entry], which are 0
  /// at the beginning of the batch.
  std::function<std::unique_ptr<PathScorer>(const PathWalks&, std::span<Complex> sums)> scorer;
  /// Returns the contribution of paths of one scatterer to the quantities in closed form,
  /// [quantity][entry]. An empty function if there is no closed form; walks must then sample these
  /// paths.
  std::function<std::vector<Complex>(const PathWalks&)> single{};
};

/// Makes a job that scores the paths of walks. Throws InputError if rays are curved; curved rays
/// are implemented only for fields and covariances. Throws std::logic_error if the plan requires a
/// closed form for paths of one scatterer and there is none.
PathJob path_job(const ScoredPaths& paths, const Scene& scene, const Plan& plan,
                 std::uint64_t seed);

/// Makes a job from its batches. single: contribution of paths of one scatterer in closed form,
/// [quantity][entry]; empty if walks sample these paths.
PathJob path_job(const Scene& scene, const Plan& plan, std::size_t quantities,
                 const std::vector<Complex>& single, const SummedBatches& batches);

/// Function that samples batch `number` of light paths and adds their fields to an accumulator.
using PathBatches = std::function<void(std::uint64_t number, Accumulator&)>;
/// Makes batches of plan.paths_per_batch paths.
PathBatches path_batches(const Scene& scene, const Plan& plan, std::uint64_t seed);

/// Makes the Monte Carlo estimator of a scene's covariance from numbered batches of light paths
/// (conventions, C13-C18). The covariance is absolute: it is the covariance of the amplitudes of C4
/// for plane waves of unit amplitude. For slabs it is divided by the illuminated length. The mean
/// field of the job is coherent_field().
FieldJob covariance_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

}  // namespace flatspeckle::mc
