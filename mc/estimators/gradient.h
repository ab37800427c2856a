#pragma once

#include <cstdint>
#include <vector>

#include "mc/estimators/medium_slope.h"
#include "mc/jobs/gradient_job.h"
#include "mc/walk/plan.h"

namespace flatspeckle::mc {

/// As make_plan(), but g = 0 of hg is free to change. Throws as check_gradient().
Plan gradient_plan(const Scene& scene, ReversedPaths reversed);

GradientJob gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

/// Of a job whose quantities after the covariance are derivatives by these.
PathJob slope_job(const Scene& scene, const Plan& plan, const std::vector<MediumSlope>& slopes,
                  std::uint64_t seed);

}  // namespace flatspeckle::mc
