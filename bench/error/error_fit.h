#pragma once

#include <vector>

#include "bench/error/error_curve.h"

namespace flatspeckle::bench {

/// What g of a slab is off by, found from exact curves that are said to have errors, the smaller
/// the longer it takes: by transport, whose ordinates grow in number, and by paths, whose number
/// does.
std::vector<ErrorRun> fit_error_runs();

}  // namespace flatspeckle::bench
