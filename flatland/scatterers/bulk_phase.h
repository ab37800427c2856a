#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "core/numbers/random.h"

namespace flatspeckle {

/// A phase function of the bulk, even in the scattering angle (conventions, C5).
struct BulkPhase {
  /// Per radian, of theta in [0, pi]. Empty: the scatterer says what it is.
  std::function<double(double theta)> density;
  double g = 0;      ///< mean cosine
  std::string text;  ///< of a table: every number, which tells one from another
};

/// A phase function of scalar waves in space, per steradian (conventions, C41).
struct SpacePhase {
  std::function<double(double cosine)> density;
  std::function<double(RandomStream& random)> one_minus_cosine;  ///< of a turn drawn from it
};

/// C22, per radian; for |g| near 1 to all digits.
inline double henyey_greenstein(double g, double theta) {
  const double half_sine = std::sin(theta / 2);
  return (1 - g) * (1 + g) /
         (2 * std::numbers::pi * ((1 - g) * (1 - g) + 4 * g * half_sine * half_sine));
}

}  // namespace flatspeckle
