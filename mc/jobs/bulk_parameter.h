#pragma once

#include <string>

namespace flatspeckle::mc {

/// Parameters of a medium with respect to which derivatives are computed, with all others held
/// fixed. radius and index (its real part) belong to the scatterers, whose number per area or
/// volume is then fixed.
enum class BulkParameter { mu_t, g, albedo, radius, index };

/// Returns the name of a parameter in result files.
inline std::string name_of(BulkParameter parameter) {
  constexpr const char* names[] = {"mu_t", "g", "albedo", "radius", "index"};
  return names[static_cast<std::size_t>(parameter)];
}

/// Returns d log p / dg, where p is the Henyey-Greenstein phase function in 2D (C22) or 3D.
/// one_minus_cosine: 1 - cos of the scattering angle.
inline double henyey_greenstein_derivative(double g, double one_minus_cosine, int dimension = 2) {
  const double rest = 1 - g;
  return dimension * (rest - one_minus_cosine) / (rest * rest + 2 * g * one_minus_cosine) -
         2 * g / (rest * (1 + g));
}

}  // namespace flatspeckle::mc
