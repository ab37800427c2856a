#pragma once

#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "mc/fit/plan/fit_plan.h"

namespace flatspeckle::mc {

extern const DatasetTable plan_table;
void write_plan(ResultFile& file, const PlanTask& task, const FitPlan& plan);

/// A plan of the same free keys at each of several points.
struct PlanPoint {
  std::string name;
  FitPlan plan;
};
void write_plans(ResultFile& file, const PlanTask& task, const std::vector<PlanPoint>& points);

}  // namespace flatspeckle::mc
