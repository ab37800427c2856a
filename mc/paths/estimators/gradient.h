#pragma once

#include <cstdint>
#include <vector>

#include "mc/jobs/gradient_job.h"
#include "mc/paths/estimators/medium_derivative.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Makes a plan as make_plan() does, but for scatterer = hg with g = 0 it keeps the
/// Henyey-Greenstein form, which has a derivative with respect to g. Throws as check_gradient()
/// does.
Plan gradient_plan(const Scene& scene, ReversedPaths reversed);

GradientJob gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

/// Makes a job whose quantities are the covariance and then the given derivatives of it.
PathJob derivative_job(const Scene& scene, const Plan& plan,
                       const std::vector<MediumDerivative>& derivatives, std::uint64_t seed);

/// Makes a job for the reflectance and transmittance of each light of a 2D scene, with derivatives
/// from the same walks: light that leaves the medium is weighted by the logarithmic derivative of
/// the density of the walk. Entries are [light][reflected, transmitted]. Quantities are the power
/// shares, then their derivatives with respect to each parameter. Walks are not split by depth, so
/// the job is inefficient for thick media.
PathJob flux_derivative_job(const Scene& scene, const std::vector<MediumDerivative>& derivatives,
                            std::uint64_t seed);

/// Makes a job for the change of a covariance C(rho) if the number N of scatterers is fixed instead
/// of Poisson-distributed, to first order in 1/N. The mean of the covariance over
/// Poisson-distributed numbers is C(rho), so the covariance for the fixed number N is C - rho^2 C''
/// / (2 N), where C'' is the second derivative with respect to the density rho. A path of B
/// scatterers and extinction exp(-mu_t L) contributes rho^2 C'' = [(B - mu_t L)^2 - B] C.
/// Quantities: the covariance, then rho^2 C''.
PathJob fixed_count_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

}  // namespace flatspeckle::mc
