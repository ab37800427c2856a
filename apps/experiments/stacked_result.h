#pragma once

#include "apps/experiments/experiment_sweep.h"
#include "apps/sweep/point_store.h"

namespace flatspeckle::apps {

/// Writes the results of the finished points as one: each dataset with the swept axes in front of
/// its own where all points of a grid are there, else with `point` in front, and the costs of each
/// point. What only some points have, or in other shapes, is left out and named in an attribute;
/// but marks of rare paths, which are 0 where there are none.
void write_stacked(ResultFile& file, const ExperimentSweep& sweep, const PointStore& store);

}  // namespace flatspeckle::apps
