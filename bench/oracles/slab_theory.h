#pragma once

#include <memory>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::oracles {

/// The covariance of an infinite slab of isotropic scatterers without random numbers: C14 and C18
/// with the transverse positions integrated by hand leave integral equations in depth,
///   c(z) = mu_t s(z) + albedo int K(z - z') c(z') dz',  K(d) = mu_t/pi K_0(|d| sqrt(mu_t^2 +
///   q^2)),
/// q the transverse momentum that both paths carry along; a ladder has s = e_i1 conj(e_i2) and is
/// seen through e_v1 conj(e_v2), the crossed diagrams (F1 conj R2) have s = e_i1 conj(e_v2) and are
/// seen through e_v1 conj(e_i2). Solved on cells of equal thickness, to about 1e-4.
class IsotropicSlab {
 public:
  IsotropicSlab(double k, double depth, double mu_t, double albedo, int cells = 400);
  ~IsotropicSlab();

  /// Angles of a channel: light, |light| < pi/2, and far view.
  struct Channel {
    double light, view;
  };
  /// B = 1 in closed form.
  Complex single(Channel a, Channel b) const;
  /// B >= 2, F conj(F).
  Complex ladder(Channel a, Channel b) const;
  /// B >= 2, F conj(R).
  Complex crossed(Channel a, Channel b) const;
  Complex without_reversed(Channel a, Channel b) const { return single(a, b) + ladder(a, b); }
  Complex with_reversed(Channel a, Channel b) const {
    return single(a, b) + ladder(a, b) + crossed(a, b);
  }

  /// Share of the light that enters from an angle which ends in absorption.
  double absorbed(double light) const;

 private:
  /// exp(constant + slope z): an end factor of C13 without its transverse phase.
  struct Wave {
    Complex constant = 0, slope = 0;
  };
  Wave light_wave(double angle) const;
  Wave view_wave(double angle) const;
  static Wave times_conjugate(Wave a, Wave b);
  Complex mean_over_cell(Wave wave, int cell) const;

  struct Kernel;  ///< the factored operator of one q
  const Kernel& kernel(double q) const;
  std::vector<Complex> multiple_collisions(double q, Wave source) const;
  Complex chain(double q, Wave source, Wave view) const;

  double k_, depth_, mu_t_, albedo_;
  int cells_;
  mutable std::vector<std::unique_ptr<Kernel>> kernels_;
};

}  // namespace flatspeckle::oracles
