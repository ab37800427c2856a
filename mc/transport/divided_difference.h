#pragma once

#include <cmath>
#include <utility>

#include "core/numbers/complex.h"

namespace flatspeckle::mc {

/// (exp(a) - exp(b)) / (a - b)
inline Complex divided_difference(Complex a, Complex b) {
  if (a.real() < b.real()) std::swap(a, b);
  const Complex z = b - a;
  if (std::abs(z) < 1e-3) return std::exp(a) * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)));
  return std::exp(a) * ((std::exp(z) - 1.0) / z);
}

}  // namespace flatspeckle::mc
