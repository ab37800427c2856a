#pragma once

#include "mc/fit/medium_fit.h"

namespace flatspeckle::apps {

/// Estimates, their correlations, what they make of the data and what the data do not tell.
void print_fit(const mc::FitTask& task, const mc::MediumFit& fit);

}  // namespace flatspeckle::apps
