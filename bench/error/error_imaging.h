#pragma once

#include <vector>

#include "bench/error/error_curve.h"

namespace flatspeckle::bench {

/// C_I of pairs of points that pictures are predicted from, by light paths, against many more of
/// them.
std::vector<ErrorRun> imaging_error_runs();

}  // namespace flatspeckle::bench
