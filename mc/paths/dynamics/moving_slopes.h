#pragma once

#include <cstdint>
#include <vector>

#include "mc/jobs/motion.h"
#include "mc/jobs/path_job.h"
#include "mc/paths/estimators/medium_slope.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// What a parameter does to a medium and to how its scatterers move: derivatives by it.
struct MovingSlope {
  MediumSlope medium;
  double diffusion = 0;
  Vec2 velocity{};
  double shear = 0;
};

/// As delay_job(), with derivatives from the same paths: the covariances of the fields at time 0
/// and after each delay, then their derivatives by each parameter, [1 + parameter][1 +
/// delay][channel]. For an intensity request of a medium that is the same everywhere. Throws as
/// delay_job() does.
PathJob moving_slope_job(const Scene& scene, const Plan& plan, const std::vector<double>& delays,
                         const Motion& motion, const std::vector<MovingSlope>& slopes,
                         std::uint64_t seed);

}  // namespace flatspeckle::mc
