#pragma once

#include <vector>

#include "bench/cost/cost_curve.h"
#include "bench/error/error_curve.h"
#include "bench/plan/plan_row.h"
#include "bench/stability/extreme_case.h"
#include "core/result/result_file.h"

namespace flatspeckle::apps {

struct ExaminedCase {
  bench::ExtremeCase extreme;
  bench::Finding finding;
  double cpu_s = 0;
};

// The functions below write results of `bench` into a result file (docs/format.md).
void write_error_curves(ResultFile& file, const std::vector<bench::ErrorCurve>& curves);
void write_cost_curves(ResultFile& file, const std::vector<bench::CostCurve>& costs);
void write_cases(ResultFile& file, const std::vector<ExaminedCase>& cases);
void write_plan_rows(ResultFile& file, const std::vector<bench::PlanRow>& rows);

}  // namespace flatspeckle::apps
