#pragma once

#include <cmath>
#include <numbers>

#include "core/keys/keys.h"
#include "flatland/scatterers/bulk_phase.h"

namespace flatspeckle {

/// Rayleigh scattering of unpolarized light in the plane, by thin dielectric cylinders: the sum of
/// a uniform pattern (E along the axis) and a cos^2 pattern (E across the axis).
struct Rayleigh {
  static constexpr const char* word = "rayleigh";
};

inline void add_keys(Keys&, Rayleigh&) {}

inline BulkPhase make_phase(const Keys&, const Rayleigh&) {
  return {[](double theta) {
            const double cosine = std::cos(theta);
            return (1 + cosine * cosine) / (3 * std::numbers::pi);
          },
          0, ""};
}

}  // namespace flatspeckle
