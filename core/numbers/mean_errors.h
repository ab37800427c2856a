#pragma once

#include "core/numbers/statistics.h"

namespace flatspeckle {

/// Means of sums of entries: that of number i adds up `parts` entries from i stride on.
struct EntrySums {
  std::size_t count, stride = 1, parts = 1;
};

/// An error that fewer of 256 groups than this make up is carried by a few of them
/// (Estimate::rare); of fewer groups in all so many fewer.
constexpr double few_groups = 24;

/// jackknife() that marks what fewer than `few` groups of 256 make up.
Estimate jackknife(const GroupedSums& sums, const Estimator& theta, double few);

/// jackknife() of these sums / samples. They are linear: leaving a group out moves them in
/// proportion to how far the group's own mean is off, so that nothing is left out one at a time.
Estimate jackknife(const GroupedSums& sums, const EntrySums& of, double few = few_groups);

}  // namespace flatspeckle
