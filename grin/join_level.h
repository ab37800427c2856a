#pragma once

#include <vector>

namespace flatspeckle::grin {

/// The level L at which sum over joins of min(1, promised / L) is `wanted`; 0 where all the joins
/// are no more than that.
double join_level(std::vector<double> promised, double wanted);

}  // namespace flatspeckle::grin
