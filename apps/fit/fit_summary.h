#pragma once

#include <string>
#include <vector>

#include "mc/fit/medium_fit.h"
#include "mc/fit/plan/fit_plan.h"
#include "mc/fit/task/fit_task.h"

namespace flatspeckle::apps {

/// Fits of the same measurements by other media side by side, likeliest first: chi^2, how likely so
/// much of it is, and Akaike's weights of the media, exp(-chi^2 / 2 - parameters) over their sum.
/// Throws InputError for what is no fit, and for fits of other measurements.
void print_compared_fits(const std::vector<std::string>& paths);

/// Prints what would be known, from how many patterns, and which views and tilts matter.
void print_plan(const mc::PlanTask& task, const mc::FitPlan& plan);

/// Prints how many patterns tell each key to 1 %, for each point.
void print_plans(const mc::PlanTask& task, const std::vector<mc::PlanPoint>& points);

/// Prints the estimates, their correlations, what they make of the data and what the data do not
/// tell.
void print_fit(const mc::FitTask& task, const mc::MediumFit& fit);

}  // namespace flatspeckle::apps
