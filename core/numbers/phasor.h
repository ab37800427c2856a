#pragma once

#include <span>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Computes out[j] = exp(log_magnitude[j] + i phase[j]) for arrays of equal length, vectorised,
/// with a relative error of 4e-16. All arguments must be finite.
void damped_phasors(std::span<const double> phase, std::span<const double> log_magnitude,
                    std::span<Complex> out);

/// Computes out[j] = exp(log_magnitude[j]) for arrays of equal length, vectorised.
void damping(std::span<const double> log_magnitude, std::span<double> out);

}  // namespace flatspeckle
