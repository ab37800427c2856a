#pragma once

#include <cmath>

namespace flatspeckle::grin {

/// Attenuation of intensity over a length, in any number of dimensions.
inline double transmittance(double mu_t, double length) {
  return std::exp(-mu_t * length);
}

/// Distance to the next scattering event of density mu_t exp(-mu_t s), from a uniform u in (0, 1).
inline double sample_free_flight(double mu_t, double u) {
  return -std::log(u) / mu_t;
}

/// The same on condition that it is no longer than `longest`: exact also where mu_t longest is
/// tiny.
struct BoundedFlight {
  double mu_t, longest;

  /// Of a flight no longer than that.
  double probability() const { return -std::expm1(-mu_t * longest); }
  double sample(double u) const {
    if (mu_t * longest == 0) return u * longest;
    return -std::log1p(u * std::expm1(-mu_t * longest)) / mu_t;
  }
  double density(double distance) const {
    if (mu_t * longest == 0) return 1 / longest;
    return mu_t * std::exp(-mu_t * distance) / probability();
  }
};

}  // namespace flatspeckle::grin
