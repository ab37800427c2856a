#pragma once

#include <span>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// out[j] = exp(log_magnitude[j] + i phase[j]) for arrays of one length, vectorised (4e-16
/// accurate). All arguments must be finite.
void damped_phasors(std::span<const double> phase, std::span<const double> log_magnitude,
                    std::span<Complex> out);

/// out[j] = exp(log_magnitude[j]), likewise.
void damping(std::span<const double> log_magnitude, std::span<double> out);

}  // namespace flatspeckle
