#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::wave {

/// exp(beta (sqrt(1 - t^2) - 1)) on |t| < 1, else 0: a bump whose transform falls to about
/// exp(-beta) of its peak at the frequency beta (Barnett, Magland, af Klinteberg 2019). It serves
/// as spreading kernel, as window and as the mollifier below.
double bump(double beta, double t);

/// Nodes and weights on (-1, 1) for integrands that are analytic inside, with frequencies up to
/// about `frequency`, and possibly singular at the ends (tanh-sinh); exact to rounding.
struct Quadrature {
  std::vector<double> nodes, weights;
};
Quadrature double_exponential_rule(double frequency);

/// ln(1 / tolerance) and a margin: the beta that an accuracy takes.
double bump_exponent(double tolerance);

/// H_0(k r) = far(r) + i near(r). far is H_0 convolved with a radial mollifier of radius `range`
/// whose transform is 1 at k: by the mean-value property of waves it is H_0 itself beyond `range`
/// and has the same real part, J_0, everywhere, while its transform is negligible beyond `band`. So
/// near is real and vanishes beyond `range`. The mollifier is bump(beta, r / range) J_0(centre r),
/// whose transform is largest at `centre`: close enough to k not to exceed the 1 at k by much.
class KernelSplit {
 public:
  KernelSplit(double k, double range, double tolerance);
  /// Spatial frequency that the far part of such a split is limited to; above k.
  static double band(double k, double range, double tolerance);

  double k() const { return k_; }
  double range() const { return range_; }
  double band() const { return shape_.centre + shape_.beta / range_; }

  /// At distances r >= 0; at r = 0, where H_0 is left out, near = -Im far.
  void near(std::span<const double> r, std::span<double> values) const;
  void far(std::span<const double> r, std::span<Complex> values) const;

 private:
  Complex moment(double from, double to) const;
  void smooth_y0(std::span<const double> r, std::span<double> values) const;

  struct Mollifier {
    double centre, beta;
  };
  static Mollifier mollifier(double k, double range, double tolerance);

  double k_, range_;
  Mollifier shape_;
  std::vector<double> chebyshev_;  // of Im far on [0, range] in 2 (r / range)^2 - 1
};

}  // namespace flatspeckle::wave
