#pragma once

#include <optional>
#include <vector>

#include "apps/sweep/point_result.h"
#include "apps/sweep/sweep_plan.h"
#include "core/result/result_file.h"

namespace flatspeckle::apps {

/// [run] of a plan; what is not there has not been finished.
using SweepResults = std::vector<std::optional<PointResult>>;

/// Points that every method has finished.
std::vector<std::size_t> finished_points(const SweepPlan& plan, const SweepResults& results);

/// Axes, curves, ranges, theory, costs and traces of the finished points, as docs/format.md says:
/// on the sweep's own axes where all are there, else as a list. There must be one at least.
void write_sweep(ResultFile& file, const SweepPlan& plan, const SweepResults& results);

}  // namespace flatspeckle::apps
