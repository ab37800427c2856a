#pragma once

#include <vector>

#include "grin/render/values/render_values.h"

namespace flatspeckle::oracles {

/// A parallel beam of radius 1 and power 1 along the axis of a parabolic guide, n^2 = 2.25 -
/// alpha^2 rho^2, through which it goes from z = 0 to `length`. Along a ray that starts at rho,
/// x = rho cos(alpha sigma) and z = sigma sqrt(2.25 - alpha^2 rho^2) (conventions, C27).
struct GuidedBeam {
  double alpha, length, mu_a = 0;

  /// Where a ray lands, signed.
  double landing(double rho) const;
  double arc_length(double rho) const;
  /// On a disk about the axis, of a picture of the beam in which only the middle is on it.
  double power(double radius) const;
  /// Its derivative by alpha.
  double by_alpha(double radius) const;
};

/// It, and disks of these radii on its far side. g: of what scatters, 1 - 1e-9 turns nothing.
grin::RenderValues guided_values(const GuidedBeam& beam, std::vector<double> radii, double mu_s = 0,
                                 double g = 0);

}  // namespace flatspeckle::oracles
