#pragma once

#include <cstdint>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::bench {

/// wave::wave_job (its covariance alone) with a solver of one's choice instead of the automatic
/// one.
FieldJob exact_job(const Scene& scene, wave::Method solver, std::uint64_t seed);

}  // namespace flatspeckle::bench
