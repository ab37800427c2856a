#pragma once

#include <cmath>

namespace flatspeckle {

/// log sinh(a), a > 0, without overflow.
inline double log_sinh(double a) {
  return a + std::log(-std::expm1(-2 * a) / 2);
}

}  // namespace flatspeckle
