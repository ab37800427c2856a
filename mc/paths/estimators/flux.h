#pragma once

#include <cstdint>

#include "mc/jobs/flux_job.h"

namespace flatspeckle::mc {

/// For the lights of the scene's request; its views do not matter. angle_bins: equal bins of the
/// exit angle (C2) over (-pi, pi]. The relative error of a run is the largest one of any light's
/// shares.
FluxJob flux_job(const Scene& scene, std::size_t angle_bins, std::uint64_t seed);

}  // namespace flatspeckle::mc
