#pragma once

#include <cstdint>
#include <vector>

#include "mc/jobs/motion.h"
#include "mc/jobs/path_job.h"
#include "mc/paths/estimators/medium_derivative.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Derivatives of a medium and of the motion of its scatterers with respect to a parameter.
struct MovingDerivative {
  MediumDerivative medium;
  double diffusion = 0;
  Vec velocity{};
  double shear = 0;
};

/// Makes a job like delay_job() that also estimates derivatives with respect to parameters, from
/// the same paths. The quantities, [1 + parameter][1 + delay][channel], are the covariances of the
/// field at time 0 with itself and with the field after each delay, then the derivatives of these
/// covariances with respect to each parameter. Requires an intensity request and a homogeneous
/// medium. Throws as delay_job() does.
PathJob moving_derivative_job(const Scene& scene, const Plan& plan,
                              const std::vector<double>& delays, const Motion& motion,
                              const std::vector<MovingDerivative>& derivatives, std::uint64_t seed);

}  // namespace flatspeckle::mc
