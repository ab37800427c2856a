#pragma once

#include <cmath>
#include <vector>

namespace flatspeckle::grin {

/// Of the modes of light in a uniform medium without edges, that which dies out slowest (Case
/// 1960), backwards: what light at depth z, at cosine mu from the axis, is worth far ahead. Lengths
/// in mean free paths. A flight from z, mu on average keeps departing(z, mu), if it is worth
/// arriving(z', mu) in the collision at its end, or departing(z', mu) where it is cut short; a turn
/// from mu on average makes departing(z, mu') of arriving(z, mu), the albedo included. So a path
/// that is followed in any manner gains nothing on average, and most of the light that is through
/// has come to the same worth.
///   departing = exp(kappa z) psi(mu),  arriving = exp(kappa z) (1 - kappa mu) psi(mu),
/// psi from its moments psi_l, (2l+1) (1 - albedo g^l) psi_l = kappa [(l+1) psi_(l+1) + l
/// psi_(l-1)]; without absorption departing = z + mu / (1 - g) and arriving = z + g mu / (1 - g).
class SlowMode {
 public:
  /// Of Henyey-Greenstein scattering.
  SlowMode(double albedo, double g);

  double kappa() const { return kappa_; }

  /// exp(kappa z); without absorption z.
  double growth(double z) const { return kappa_ > 0 ? std::exp(kappa_ * z) : z; }
  /// At such a growth.
  double departing(double growth, double mu) const {
    return kappa_ > 0 ? growth * scattered(mu) / (1 - kappa_ * mu) : growth + drift_ * mu;
  }
  double arriving(double growth, double mu) const {
    return kappa_ > 0 ? growth * scattered(mu) : growth + g_ * drift_ * mu;
  }

 private:
  /// Legendre series, by Clenshaw's recurrence.
  double scattered(double mu) const {
    double next = 0, after = 0;
    for (std::size_t l = series_.size(); l-- > 1;) {
      const double n = static_cast<double>(l);
      const double here =
          series_[l] + (2 * n + 1) / (n + 1) * mu * next - (n + 1) / (n + 2) * after;
      after = next;
      next = here;
    }
    return series_[0] + mu * next - after / 2;
  }

  double kappa_, g_, drift_;
  std::vector<double> series_;
};

/// How fast light of all directions dies out with depth deep inside a medium, per mean free path
/// and as a factor: exp(-rate mu_t z). The smallest root of the transport equation's dispersion
/// relation for Henyey-Greenstein scattering in flatland or in space; 0 without absorption.
double diffusion_rate(double albedo, double g, int dimension);

}  // namespace flatspeckle::grin
