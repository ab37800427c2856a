#pragma once

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "mc/fit/fit_plan.h"

namespace flatspeckle::mc {

extern const DatasetTable plan_table;
void write_plan(ResultFile& file, const PlanTask& task, const FitPlan& plan);

}  // namespace flatspeckle::mc
