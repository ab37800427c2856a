#pragma once

#include <cmath>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Returns log sinh(a), a > 0, without overflow.
inline double log_sinh(double a) {
  return a + std::log(-std::expm1(-2 * a) / 2);
}

/// Returns log sinh(a) for complex a with Re a >= 0, without overflow.
inline Complex log_sinh(Complex a) {
  return a.real() < 1 ? std::log(std::sinh(a)) : a + std::log((1.0 - std::exp(-2.0 * a)) / 2.0);
}

}  // namespace flatspeckle
