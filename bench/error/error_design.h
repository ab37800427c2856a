#pragma once

#include <vector>

#include "bench/error/error_curve.h"

namespace flatspeckle::bench {

/// What the index of a lens is off by (r < 0.9, root mean square) that was sought from n = 1,
/// against Luneburg's: radial profiles and splines in space of more and more coefficients.
std::vector<ErrorRun> design_error_runs();

}  // namespace flatspeckle::bench
