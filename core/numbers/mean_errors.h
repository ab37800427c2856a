#pragma once

#include "core/numbers/statistics.h"

namespace flatspeckle {

/// Means of sums of entries: that of number i adds up `parts` entries from i stride on.
struct EntrySums {
  std::size_t count, stride = 1, parts = 1;
};

/// jackknife() of these sums / samples. They are linear: leaving a group out moves them in
/// proportion to how far the group's own mean is off, so that nothing is left out one at a time.
Estimate jackknife(const GroupedSums& sums, const EntrySums& of);

}  // namespace flatspeckle
