#pragma once

#include <vector>

#include "grin/render/values/render_values.h"

namespace flatspeckle::oracles {

/// A parallel beam of radius 1 and power 1 along the axis of a parabolic guide, n^2 = 2.25 -
/// alpha^2 rho^2, from z = 0 to `length`. Along a ray that starts at rho, x = rho cos(alpha sigma)
/// and z = sigma sqrt(2.25 - alpha^2 rho^2) (conventions, C27).
struct GuidedBeam {
  double alpha, length, mu_a = 0;

  /// Signed landing position of a ray.
  double landing(double rho) const;
  double arc_length(double rho) const;
  /// Power on a disk around the axis, provided that only rays from the central part of the beam
  /// land on it.
  double power(double radius) const;
  /// Derivative of the power with respect to alpha.
  double by_alpha(double radius) const;
};

/// Returns the scene of the beam and disks of these radii on the far side. g is the anisotropy of
/// the scatterers; with g = 1 - 1e-9 scattering hardly deflects light.
grin::RenderValues guided_values(const GuidedBeam& beam, std::vector<double> radii, double mu_s = 0,
                                 double g = 0);

}  // namespace flatspeckle::oracles
