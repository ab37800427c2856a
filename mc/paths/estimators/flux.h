#pragma once

#include <cstdint>

#include "mc/jobs/flux_job.h"

namespace flatspeckle::mc {

/// Makes the flux job for the lights of the scene's request; the views of the request are not used.
/// angle_bins: number of equal bins of the exit angle (C2) over (-pi, pi]. The relative error of a
/// run is the largest relative error of any share of any light.
FluxJob flux_job(const Scene& scene, std::size_t angle_bins, std::uint64_t seed);

}  // namespace flatspeckle::mc
