#pragma once

#include <cstdint>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/paths/walk/accumulator.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// The Monte Carlo estimator of a scene's covariance as numbered batches of light paths
/// (conventions, C13-C18). The covariance is absolute: that of C4 amplitudes for unit plane waves,
/// on a slab per unit illuminated length. The mean field is that of coherent_field.h.
using PathBatches = std::function<void(std::uint64_t number, Accumulator&)>;
/// Numbered batches of plan.paths_per_batch paths, handed to an accumulator.
PathBatches path_batches(const Scene& scene, const Plan& plan, std::uint64_t seed);

FieldJob covariance_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

}  // namespace flatspeckle::mc
