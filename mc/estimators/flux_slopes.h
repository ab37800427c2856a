#pragma once

#include <cstdint>
#include <vector>

#include "mc/estimators/medium_slope.h"
#include "mc/jobs/path_job.h"

namespace flatspeckle::mc {

/// Reflectance and transmittance of each light of a scene in the plane, with derivatives from the
/// same walks: what leaves is weighed by the logarithmic derivative of the walk's density. Entries
/// [light][reflected, transmitted], quantities [1 + parameter]. Walkers are not drawn to what is
/// deep: for media that are not thick.
PathJob flux_slope_job(const Scene& scene, const std::vector<MediumSlope>& slopes,
                       std::uint64_t seed);

}  // namespace flatspeckle::mc
