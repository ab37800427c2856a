#pragma once

#include <cstdint>

#include "flatland/scene/scene.h"
#include "mc/jobs/path_job.h"
#include "mc/walk/plan.h"

namespace flatspeckle::mc {

/// What a fixed number N of scatterers changes of a covariance C(rho) of a Poisson number, to first
/// order in 1/N: the mean of C over Poisson numbers being C(rho), that of the number N itself is
/// C - rho^2 C'' / (2 N). A path of B scatterers and extinction exp(-mu_t L) carries
/// rho^2 C'' = [(B - mu_t L)^2 - B] C. Quantities: the covariance, then rho^2 C''.
PathJob fixed_count_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

}  // namespace flatspeckle::mc
