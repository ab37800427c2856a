#pragma once

#include <cstdint>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/jobs/changed_fields.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Makes a job that samples walks for fields at two frequencies (conventions, C39). The free
/// flights between the scatterers of a path rotate the phase of its covariance by (k1 - k2) times
/// their total length, and the endpoint factors of each field contain the wavenumber of that field.
/// The quantities are the covariance, then for each shift the covariance of the first field with
/// the second field at the shifted frequency. The latter is 0 for entries without a shifted second
/// field (changing_entries()). The shifts must have been checked (check_frequency_shifts()).
PathJob frequency_job(const Scene& scene, const Plan& plan, const std::vector<double>& shifts,
                      std::uint64_t seed);
/// Makes the plan for frequency_job(), as make_plan() does, but always with phases.
Plan frequency_plan(const Scene& scene, ReversedPaths reversed);

}  // namespace flatspeckle::mc
