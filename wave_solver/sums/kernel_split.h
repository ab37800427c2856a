#pragma once

#include <span>
#include <vector>

#include "core/numbers/bessel.h"
#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// Returns exp(beta (sqrt(1 - t^2) - 1)) on |t| < 1, else 0: a bump whose Fourier transform falls
/// to about exp(-beta) of its peak at the frequency beta [barnett2019]. It is used as spreading
/// kernel, in a window, and in the mollifier of KernelSplit.
double bump(double beta, double t);

/// Nodes and weights of tanh-sinh quadrature on (-1, 1). It is exact to rounding for integrands
/// that are analytic inside and contain frequencies up to about `frequency`, even if they are
/// singular at the ends.
struct Quadrature {
  std::vector<double> nodes, weights;
};
Quadrature double_exponential_rule(double frequency);

/// Returns the beta that an accuracy requires: ln(1 / tolerance) plus a margin.
double bump_exponent(double tolerance);

/// Computes the outgoing wave of order 0 at arguments x > 0: H_0 in the plane (cylindrical), h_0 =
/// -i e^{ix} / x in space (spherical).
void outgoing_wave(Radial kind, std::span<const double> x, std::span<Complex> h);

/// Splits H_0(k r) = far(r) + i near(r), or the same with h_0 in space. far is H_0 convolved with a
/// radial mollifier of radius `range` whose Fourier transform is 1 at k. By the mean-value property
/// of waves, far equals H_0 beyond `range`, and has the same real part, J_0, everywhere. near is
/// therefore real and vanishes beyond `range`. The transform of far is negligible beyond `band`.
/// The mollifier is bump(beta, r / range) J_0(centre r), in space with j_0. Its transform is
/// largest at `centre`, which is so close to k that the maximum is not much larger than 1.
class KernelSplit {
 public:
  KernelSplit(double k, double range, double tolerance, Radial kind = Radial::cylindrical);
  /// Returns the spatial frequency, above k, beyond which the Fourier transform of far is
  /// negligible.
  static double band(double k, double range, double tolerance);

  double k() const { return k_; }
  double range() const { return range_; }
  double band() const { return shape_.centre + shape_.beta / range_; }

  /// These functions evaluate near and far at distances r >= 0. At r = 0, where H_0 is omitted,
  /// near = -Im far.
  void near(std::span<const double> r, std::span<double> values) const;
  void far(std::span<const double> r, std::span<Complex> values) const;

 private:
  Complex moment(double from, double to) const;
  void wave(std::span<const double> x, std::span<Complex> h) const { outgoing_wave(kind_, x, h); }
  void smooth_y0(std::span<const double> r, std::span<double> values) const;

  struct Mollifier {
    double centre, beta;
  };
  static Mollifier mollifier(double k, double range, double tolerance);

  double k_, range_;
  Radial kind_;
  Mollifier shape_;
  std::vector<double> chebyshev_;  // series of Im far on [0, range] in 2 (r / range)^2 - 1
};

}  // namespace flatspeckle::wave
