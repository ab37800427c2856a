#pragma once

#include "core/result/invariant.h"
#include "wave_solver/solutions/space_solution.h"

namespace flatspeckle::wave {

/// Returns the largest violation of the boundary conditions over points on the spheres with the
/// smallest gaps and over all lights, as boundary_residual() of a WaveSolution. The fields of all
/// waves and their derivatives are summed outside of the spheres. Returns 0 if there are no
/// spheres. tolerance: accuracy of beams.
double boundary_residual(const SpaceSolution& solution, double tolerance);

/// Directions and weights that integrate |A|^2 over the sphere: Gauss nodes in cos(theta) and equal
/// steps in the azimuth.
struct SphereRule {
  std::vector<View> views;
  std::vector<double> weights;
};
/// Returns the rule for scatterers within the distance R of a point, with size = k R.
SphereRule sphere_rule(double size);

/// Returns the integral of |A|^2 over all directions for one light, as the sum over pairs of waves
/// b of (1/k^2) b* (1 + Re S) b (C61).
double power_of_waves(const SpaceSolution& solution, std::size_t light);

/// Returns |extinction - scattering - absorption| / extinction of the whole placement: the largest
/// value over a few of the plane waves (C56). Scattering is the integral of |A|^2 over all
/// directions, or power_of_waves() for large placements; absorption follows from T. Returns an
/// Invariant that holds if no light is a plane wave.
Invariant power_balance(const SpaceSolution& solution);

}  // namespace flatspeckle::wave
