#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "core/numbers/random.h"

namespace flatspeckle {

/// Phase function of a medium without individual scatterers (the bulk). It is even in the
/// scattering angle (conventions, C5).
struct BulkPhase {
  /// Probability density per radian for theta in [0, pi]; its integral over the full circle is 1.
  /// Empty if the scatterer itself defines the phase function.
  std::function<double(double theta)> density;
  double g = 0;  ///< mean cosine
  /// All numbers of a tabulated phase function, so that different tables have different texts;
  /// empty if the function is not tabulated.
  std::string text;
};

/// Phase function of scalar waves in three dimensions, per steradian (conventions, C41).
struct SpacePhase {
  std::function<double(double cosine)> density;
  /// Draws a scattering angle from the phase function and returns 1 - cos of the angle.
  std::function<double(RandomStream& random)> one_minus_cosine;
};

/// Returns the Henyey-Greenstein phase function of the plane (C22) per radian, in full precision
/// also for |g| near 1.
inline double henyey_greenstein(double g, double theta) {
  const double half_sine = std::sin(theta / 2);
  return (1 - g) * (1 + g) /
         (2 * std::numbers::pi * ((1 - g) * (1 - g) + 4 * g * half_sine * half_sine));
}

}  // namespace flatspeckle
