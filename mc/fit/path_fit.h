#pragma once

#include "mc/fit/medium_fit.h"

namespace flatspeckle::mc {

/// Least squares by Monte Carlo, in any medium: the errors of the model count beside those of the
/// measurements, and paths become more until they add no more than the stated share. Throws
/// InputError.
MediumFit fit_by_paths(const FitTask& task);

/// Throws InputError for what paths cannot tell.
void check_paths(const FitTask& task);

}  // namespace flatspeckle::mc
