#pragma once

#include <cmath>
#include <numbers>

#include "core/keys/keys.h"
#include "flatland/scatterers/bulk_phase.h"

namespace flatspeckle {

/// Unpolarized light on what is small against its wavelength: in the plane thin dielectric
/// cylinders, uniform for E along the axis and cos^2 across it.
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
