#pragma once

#include <vector>

#include "apps/sweep/sweep_plan.h"
#include "core/result/result_file.h"

namespace flatspeckle::apps {

/// Writes the axes of a sweep and what else tells its points apart, and binds GRID, the axes that a
/// quantity per point stands on: those of the sweep, or, as a list, `point` alone. scenes: of the
/// points that are written, all of them unless as a list.
void write_sweep_grid(ResultFile& file, const SweepPlan& plan, const std::vector<Scene>& scenes,
                      bool as_list);

}  // namespace flatspeckle::apps
