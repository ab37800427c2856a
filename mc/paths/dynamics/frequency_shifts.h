#pragma once

#include <cstdint>
#include <vector>

#include "mc/jobs/frequency_datasets.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Fields at two frequencies by walks (conventions, C39): the inner flights of a path turn the
/// phase of its covariance by (k1 - k2) times their length, its ends have each its own k. The job's
/// quantities are the covariance, then that with the fields at each shifted frequency, 0 where
/// entries do not change. The shifts have been checked (check_frequency_shifts()).
PathJob frequency_job(const Scene& scene, const Plan& plan, const std::vector<double>& shifts,
                      std::uint64_t seed);
/// The scene's plan, with phases.
Plan frequency_plan(const Scene& scene, ReversedPaths reversed);

}  // namespace flatspeckle::mc
