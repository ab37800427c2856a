#pragma once

#include <cstdint>
#include <vector>

#include "mc/jobs/gradient_job.h"
#include "mc/paths/estimators/medium_slope.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// As make_plan(), but g = 0 of hg is free to change. Throws as check_gradient().
Plan gradient_plan(const Scene& scene, ReversedPaths reversed);

GradientJob gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

/// Of a job whose quantities after the covariance are derivatives by these.
PathJob slope_job(const Scene& scene, const Plan& plan, const std::vector<MediumSlope>& slopes,
                  std::uint64_t seed);

/// Reflectance and transmittance of each light of a scene in the plane, with derivatives from the
/// same walks: what leaves is weighed by the logarithmic derivative of the walk's density. Entries
/// [light][reflected, transmitted], quantities [1 + parameter]. Walkers are not drawn to what is
/// deep: for media that are not thick.
PathJob flux_slope_job(const Scene& scene, const std::vector<MediumSlope>& slopes,
                       std::uint64_t seed);

/// What a fixed number N of scatterers changes of a covariance C(rho) of a Poisson number, to first
/// order in 1/N: the mean of C over Poisson numbers being C(rho), that of the number N itself is
/// C - rho^2 C'' / (2 N). A path of B scatterers and extinction exp(-mu_t L) carries
/// rho^2 C'' = [(B - mu_t L)^2 - B] C. Quantities: the covariance, then rho^2 C''.
PathJob fixed_count_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

}  // namespace flatspeckle::mc
