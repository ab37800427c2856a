#pragma once

#include "mc/fit/fit_plan.h"

namespace flatspeckle::apps {

/// What would be known, from how many patterns, and which views and tilts matter.
void print_plan(const mc::PlanTask& task, const mc::FitPlan& plan);

}  // namespace flatspeckle::apps
