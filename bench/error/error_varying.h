#pragma once

#include <vector>

#include "bench/error/error_curve.h"

namespace flatspeckle::bench {

/// A slab whose scatterers flow beside diffusing, against transport.
std::vector<ErrorRun> varying_error_runs();

}  // namespace flatspeckle::bench
