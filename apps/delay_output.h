#pragma once

#include <vector>

#include "core/result/result_file.h"
#include "flatland/scene/scene.h"
#include "mc/estimators/brownian.h"

namespace flatspeckle::apps {

/// Prints the correlation after each delay and writes it, with the covariance and, for light
/// through a slab, diffusion theory. The request's axes must have been written.
void write_delays(ResultFile& file, const Scene& scene, const mc::DelayJob& job,
                  const std::vector<double>& delays, const GroupedSums& sums);

}  // namespace flatspeckle::apps
