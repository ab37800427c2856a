#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/request/light.h"
#include "wave_solver/spheres/spherical_waves.h"

namespace flatspeckle::wave {

/// A plane wave along the unit vector w, as a part of a beam.
struct BeamWave {
  Vec w;
  Complex weight;
};

/// Expands a Gaussian beam in plane waves (C62). The error is below `tolerance`, relative to the
/// field at the focus, within the distance `reach` of the focus. Evanescent waves are left out.
std::vector<BeamWave> beam_waves(const Light& beam, double k, double reach, double tolerance);

/// Adds to `out` the coefficients of `factor` times a light in regular waves about the centres of
/// the sets, times their weights (C60, C62). tolerance: accuracy of beams. Precondition: a point
/// source is not at a centre.
void add_incident(double k, std::span<const SphereSet> sets, const Light& light, double tolerance,
                  Complex factor, std::span<Complex> out);

/// Adds to `out` `factor` times the values at a point of the outgoing waves of all sets.
void add_outgoing(double k, std::span<const SphereSet> sets, Vec point, Complex factor,
                  std::span<Complex> out);

}  // namespace flatspeckle::wave
