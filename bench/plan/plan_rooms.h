#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/plan/plan_row.h"

namespace flatspeckle::bench {

// The cases of plan_cases(), by room.
std::vector<PlanCase> mc_plan_cases();
std::vector<PlanCase> transport_plan_cases();
std::vector<PlanCase> field_plan_cases();
std::vector<PlanCase> fit_plan_cases();
std::vector<PlanCase> imaging_plan_cases();
std::vector<PlanCase> wave_plan_cases();
std::vector<PlanCase> ray_plan_cases();
std::vector<PlanCase> render_plan_cases();
std::vector<PlanCase> design_plan_cases();

/// A case whose row gets its names from here.
PlanCase named(const std::string& room, const std::string& left_out, const std::string& scene,
               const std::function<PlanRow(double cpu_seconds)>& run);

}  // namespace flatspeckle::bench
