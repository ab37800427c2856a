#pragma once

#include <cmath>
#include <numbers>

#include "core/numbers/random.h"

namespace flatspeckle {

/// Samples a normal variable of mean 0 and variance 1 (Box and Muller).
inline double standard_normal(RandomStream& random) {
  const double radius = std::sqrt(-2 * std::log(random.uniform()));
  return radius * std::cos(2 * std::numbers::pi * random.uniform());
}

}  // namespace flatspeckle
