#pragma once

#include <cstdint>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/jobs/changed_fields.h"
#include "mc/jobs/motion.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Makes a job for the fields of moving scatterers at two times (diffusing-wave spectroscopy
/// [pine1988], [maret1987]). A displacement during a time tau has variance 2 D tau along each axis.
/// Scattering by an angle theta therefore multiplies the covariance of a path by exp(-2 t (1 - cos
/// theta)), where t = k^2 D tau is the delay. The scatterers move independently, and over distances
/// that are small compared with a mean free path. If they flow with a velocity u, scattering from
/// direction w to w' also multiplies the covariance by exp(-i k (w - w').u t). The quantities are
/// the intensity, then for each delay the covariance of the fields at time 0 and after the delay,
/// which is real without flow. Throws InputError for requests other than intensity and for negative
/// delays.
PathJob delay_job(const Scene& scene, const Plan& plan, const std::vector<double>& delays,
                  std::uint64_t seed, const Motion& motion = {});

}  // namespace flatspeckle::mc
