#pragma once

#include "apps/sweep/sweep_output.h"

namespace flatspeckle::apps {

/// The ranges of the finished points on standard output, if there are not too many, and notes on
/// standard error about those that rest on too few tilts.
void print_ranges(const SweepPlan& plan, const SweepResults& results);

}  // namespace flatspeckle::apps
