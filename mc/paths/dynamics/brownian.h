#pragma once

#include <cstdint>
#include <vector>

#include "mc/jobs/delays.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Fields of moving scatterers at two times (diffusing-wave spectroscopy; Pine et al. 1988). A
/// displacement's variance is 2 D tau along each axis, so that a scatterer that turns light by
/// theta multiplies a path's covariance by exp(-2 t (1 - cos theta)), t = k^2 D tau: the delays.
/// The scatterers move independently and little against a mean free path. Where they flow with a
/// velocity u, turning light from w to w' multiplies by exp(-i k (w - w').u t) as well. The job's
/// quantities are the intensity and the covariances of the fields at time 0 and after each delay,
/// which are real without flow. For an intensity request. Throws InputError for another, and for
/// negative delays.
PathJob delay_job(const Scene& scene, const Plan& plan, const std::vector<double>& delays,
                  std::uint64_t seed, const Motion& motion = {});

}  // namespace flatspeckle::mc
