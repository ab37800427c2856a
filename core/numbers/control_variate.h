#pragma once

#include "core/numbers/statistics.h"

namespace flatspeckle {

/// jackknife() of a theta that is linear in the sums, from which what it shares with the sum number
/// `control`, known to be 0 on average, is taken away (control variate, by regression over the
/// groups). The regression's own bias is of the order of one over the samples. Only where it is
/// worth it: where groups are many, and the control tells clearly of the variance.
Estimate controlled_jackknife(const GroupedSums& sums, const Estimator& theta, std::size_t control,
                              double few = few_groups);

}  // namespace flatspeckle
