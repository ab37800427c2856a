#pragma once

#include <cmath>
#include <utility>

#include "core/algebra/dual.h"

namespace flatspeckle {

/// (exp(a) - exp(b)) / (a - b)
template <typename C>
C divided_difference(C a, C b) {
  if (value_of(a).real() < value_of(b).real()) std::swap(a, b);
  const C z = b - a;
  if (std::abs(value_of(z)) < 1e-3)
    return exp(a) * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0 * (1.0 + z / 5.0))));
  return exp(a) * ((exp(z) - 1.0) / z);
}

}  // namespace flatspeckle
