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
  /// Values that depend on the direction alone, for its cosine mu and for -mu.
  struct Angle {
    double mu;
    double scattered[2];  ///< (1 - kappa mu) psi(mu), (1 + kappa mu) psi(-mu)

    Angle reversed() const { return {-mu, {scattered[1], scattered[0]}}; }
  };
  /// Evaluates the series of Legendre polynomials, whose even and odd terms are summed separately.
  Angle angle(double mu) const {
    double even = series_[0], odd = 0, before = 1, here = mu;
    for (std::size_t l = 1; l < series_.size(); ++l) {
      (l % 2 == 0 ? even : odd) += series_[l] * here;
      const double next = mu * here + more_[l] * (mu * here - before);
      before = here;
      here = next;
    }
    return {mu, {even + odd, even - odd}};
  }

  /// Returns the importance before a free flight. `growth` is growth(z) at the start of the flight.
  double departing(double growth, const Angle& of) const {
    return kappa_ > 0 ? growth * of.scattered[0] / (1 - kappa_ * of.mu)
                      : growth + transport_length_ * of.mu;
  }
  double departing(double growth, double mu) const { return departing(growth, angle(mu)); }
  /// Returns the importance before a collision. `growth` is growth(z) at the collision.
  double arriving(double growth, const Angle& of) const {
    return kappa_ > 0 ? growth * of.scattered[0] : growth + g_ * transport_length_ * of.mu;
  }
  double arriving(double growth, double mu) const { return arriving(growth, angle(mu)); }

 private:
  double kappa_, g_, transport_length_;
  std::vector<double> series_;
  std::vector<double> more_;  ///< l / (l + 1)
};

/// Returns the rate at which light decays with depth deep inside a medium, per mean free path.
/// There, the light of all directions decays as exp(-rate mu_t z). The rate is the smallest root of
/// the transport equation's dispersion relation for Henyey-Greenstein scattering in flatland or in
/// space; 0 without absorption.
double diffusion_rate(double albedo, double g, int dimension);

}  // namespace flatspeckle::grin
