#pragma once

#include <string>

namespace flatspeckle::mc {

/// What a scene's bulk can be differentiated by, all others held fixed: radius and (real part of
/// the) index of cylinders at fixed density, of spheres at fixed extinction.
enum class BulkParameter { mu_t, g, albedo, radius, index };

/// As results call it.
inline std::string name_of(BulkParameter parameter) {
  constexpr const char* names[] = {"mu_t", "g", "albedo", "radius", "index"};
  return names[static_cast<std::size_t>(parameter)];
}

/// d log p / dg of Henyey-Greenstein's phase function, of C22 or in space, at a scattering angle of
/// known 1 - cos.
inline double henyey_greenstein_slope(double g, double one_minus_cosine, int dimension = 2) {
  const double rest = 1 - g;
  return dimension * (rest - one_minus_cosine) / (rest * rest + 2 * g * one_minus_cosine) -
         2 * g / (rest * (1 + g));
}

}  // namespace flatspeckle::mc
