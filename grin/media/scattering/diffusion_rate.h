#pragma once

#include <cmath>
#include <vector>

namespace flatspeckle::grin {

/// Adjoint of the most slowly decaying eigenmode of transport in an unbounded uniform medium
/// [case1960]. It is the importance of light at depth z, with cosine mu to the axis, for a detector
/// far ahead. Lengths are in mean free paths. The importance is a martingale along a path, for any
/// sampling of free flights: departing(z, mu) is the expected importance after a free flight, which
/// is arriving(z', mu) if the flight ends in a collision at z' and departing(z', mu) if it is cut
/// short at z'. arriving(z, mu) is albedo times the expected departing(z, mu') after scattering.
/// Most of the transmitted light leaves the medium with about the same importance.
///   departing = exp(kappa z) psi(mu),  arriving = exp(kappa z) (1 - kappa mu) psi(mu).
/// Here kappa is diffusion_rate() in 3D, and psi is computed from its Legendre moments psi_l, with
/// (2l+1) (1 - albedo g^l) psi_l = kappa [(l+1) psi_(l+1) + l psi_(l-1)]. Without absorption,
/// departing = z + mu / (1 - g) and arriving = z + g mu / (1 - g).
class CaseMode {
 public:
  /// Computes the eigenmode for Henyey-Greenstein scattering with mean cosine g.
  CaseMode(double albedo, double g);

  double kappa() const { return kappa_; }

  /// Returns exp(kappa z), or z without absorption.
  double growth(double z) const { return kappa_ > 0 ? std::exp(kappa_ * z) : z; }
  /// Returns the importance before a free flight. `growth` is growth(z) at the start of the flight.
  double departing(double growth, double mu) const {
    return kappa_ > 0 ? growth * scattered(mu) / (1 - kappa_ * mu)
                      : growth + transport_length_ * mu;
  }
  /// Returns the importance before a collision. `growth` is growth(z) at the collision.
  double arriving(double growth, double mu) const {
    return kappa_ > 0 ? growth * scattered(mu) : growth + g_ * transport_length_ * mu;
  }

 private:
  /// Returns (1 - kappa mu) psi(mu), by Clenshaw's recurrence for its Legendre series.
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

  double kappa_, g_, transport_length_;
  std::vector<double> series_;
};

/// Returns the rate at which light decays with depth deep inside a medium, per mean free path.
/// There, the light of all directions decays as exp(-rate mu_t z). The rate is the smallest root of
/// the transport equation's dispersion relation for Henyey-Greenstein scattering in flatland or in
/// space; 0 without absorption.
double diffusion_rate(double albedo, double g, int dimension);

}  // namespace flatspeckle::grin
