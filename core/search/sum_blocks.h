#pragma once

#include <cstddef>
#include <vector>

#include "core/numbers/statistics.h"

namespace flatspeckle {

/// The sums without each of `blocks` equal parts of their batches, or of as many as there are
/// groups; each with a group for each of the other blocks.
std::vector<GroupedSums> without_blocks(const GroupedSums& sums, std::size_t blocks);

}  // namespace flatspeckle
