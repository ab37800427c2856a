#pragma once

#include <string>
#include <vector>

#include "mc/fit/medium_fit.h"
#include "mc/fit/plan/fit_plan.h"
#include "mc/fit/task/fit_task.h"

namespace flatspeckle::apps {

/// Prints a comparison of fits of the same measurements with different media, the most probable
/// first: chi^2, the probability of a larger chi^2, and the Akaike weight, proportional to
/// exp(-chi^2 / 2 - number of parameters), with the sum 1. Throws InputError if a file is not a
/// result of `fit` or the files do not all fit the same measurements.
void print_compared_fits(const std::vector<std::string>& paths);

/// Prints the plan of a measurement: expected errors of the parameters, numbers of speckle patterns
/// required, and increase of the errors if a view or a tilt is left out.
void print_plan(const mc::PlanTask& task, const mc::FitPlan& plan);

/// Prints a table for all combinations of the varied keys: for each parameter, the number of
/// speckle patterns from which its error is 1 %.
void print_plans(const mc::PlanTask& task, const std::vector<mc::PlanPoint>& points);

/// Prints the result of a fit: the estimates, their correlations, the quality of the fit, and the
/// parameters that the data do not determine.
void print_fit(const mc::FitTask& task, const mc::MediumFit& fit);

}  // namespace flatspeckle::apps
