// This file is compiled with -ffast-math, so that the compiler uses vector versions of sin, cos and
// exp. It does so only if each function is called in a loop of its own.
#include "core/numbers/phasor.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle {

void damped_phasors(std::span<const double> phase, std::span<const double> log_magnitude,
                    std::span<Complex> out) {
  constexpr std::size_t chunk = 64;
  double cosine[chunk], sine[chunk], magnitude[chunk];
  for (std::size_t first = 0; first < phase.size(); first += chunk) {
    const std::size_t n = std::min(chunk, phase.size() - first);
    const double* angle = phase.data() + first;
    const double* exponent = log_magnitude.data() + first;
    for (std::size_t j = 0; j < n; ++j) cosine[j] = std::cos(angle[j]);
    for (std::size_t j = 0; j < n; ++j) sine[j] = std::sin(angle[j]);
    for (std::size_t j = 0; j < n; ++j) magnitude[j] = std::exp(exponent[j]);
    for (std::size_t j = 0; j < n; ++j)
      out[first + j] = {magnitude[j] * cosine[j], magnitude[j] * sine[j]};
  }
}

void damping(std::span<const double> log_magnitude, std::span<double> out) {
  for (std::size_t j = 0; j < log_magnitude.size(); ++j) out[j] = std::exp(log_magnitude[j]);
}

}  // namespace flatspeckle
