#pragma once

#include <cmath>

#include "grin/media/scattering/space_phase.h"

namespace flatspeckle::grin {

/// Scattering of unpolarized light by particles much smaller than a wavelength: 3/4 (1 + cos^2)
/// times the isotropic phase function.
struct RayleighPhase {
  static constexpr const char* word = "rayleigh";

  double density(double cosine) const {
    return 3 / (16 * std::numbers::pi) * (1 + cosine * cosine);
  }
  /// Solves c^3 + 3 c = 8 u - 4 for the cosine c by Cardano's formula, where u is a random number
  /// in (0, 1). The equation states that the integral of 3/8 (1 + c^2) from -1 to c is u.
  double one_minus_cosine(RandomStream& random) const {
    const double half = 4 * random.uniform() - 2;
    const double root = std::cbrt(half + std::sqrt(half * half + 1));
    return 1 - (root - 1 / root);
  }
  double mean_cosine() const { return 0; }
};

inline void add_keys(Keys&, RayleighPhase&, const std::string&) {}
inline RayleighPhase make_phase(const Keys&, const RayleighPhase& phase) {
  return phase;
}

}  // namespace flatspeckle::grin
