#pragma once

#include <memory>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::oracles {

/// Computes the covariance of an infinite slab of isotropic scatterers deterministically. C14 and
/// C18 with the transverse positions integrated analytically leave integral equations in depth,
///   c(z) = mu_t s(z) + albedo int K(z - z') c(z') dz',  K(d) = mu_t/pi K_0(|d| sqrt(mu_t^2 +
///   q^2)),
/// where q is the transverse momentum of the pair of paths. Ladder diagrams have the source s =
/// e_i1 conj(e_i2) and are detected with e_v1 conj(e_v2); crossed diagrams (F1 conj R2) have s =
/// e_i1 conj(e_v2) and are detected with e_v1 conj(e_i2). The equations are solved on cells of
/// equal thickness, to about 1e-4.
class IsotropicSlab {
 public:
  IsotropicSlab(double k, double depth, double mu_t, double albedo, int cells = 400);
  ~IsotropicSlab();

  /// Angles of a channel: illumination (|light| < pi/2) and far-field detection direction.
  struct Channel {
    double light, view;
  };
  /// Single scattering (B = 1 in C14), in closed form.
  Complex single(Channel a, Channel b) const;
  /// Multiple scattering (B >= 2), correlation of forward paths, F conj(F).
  Complex ladder(Channel a, Channel b) const;
  /// Multiple scattering (B >= 2), correlation of forward with reversed paths, F conj(R).
  Complex crossed(Channel a, Channel b) const;
  Complex without_reversed(Channel a, Channel b) const { return single(a, b) + ladder(a, b); }
  Complex with_reversed(Channel a, Channel b) const {
    return single(a, b) + ladder(a, b) + crossed(a, b);
  }

  /// Fraction of the incident power that is absorbed.
  double absorbed(double light) const;

 private:
  /// The function exp(constant + rate z): an endpoint factor of C13 without its transverse phase.
  struct Wave {
    Complex constant = 0, rate = 0;
  };
  Wave light_wave(double angle) const;
  Wave view_wave(double angle) const;
  static Wave times_conjugate(Wave a, Wave b);
  Complex mean_over_cell(Wave wave, int cell) const;

  struct Kernel;  ///< LU factors of the operator for one q
  const Kernel& kernel(double q) const;
  std::vector<Complex> multiple_collisions(double q, Wave source) const;
  Complex chain(double q, Wave source, Wave view) const;

  double k_, depth_, mu_t_, albedo_;
  int cells_;
  mutable std::vector<std::unique_ptr<Kernel>> kernels_;
};

}  // namespace flatspeckle::oracles
