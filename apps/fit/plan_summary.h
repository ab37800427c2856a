#pragma once

#include <vector>

#include "mc/fit/plan/plan_datasets.h"

namespace flatspeckle::apps {

/// What would be known, from how many patterns, and which views and tilts matter.
void print_plan(const mc::PlanTask& task, const mc::FitPlan& plan);

/// Patterns to know each key to 1 %, of each point.
void print_plans(const mc::PlanTask& task, const std::vector<mc::PlanPoint>& points);

}  // namespace flatspeckle::apps
