#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scatterers/scatterer.h"
#include "wave_solver/periodic/periodic_cell.h"

namespace flatspeckle::wave {

/// Amplitudes of the channels behind (transmitted) and before (reflected) a row of cylinders, one
/// at r = 0 and one at each multiple of the period, for unit light in one channel. Between the
/// lines z =
/// +-height the field is a sum of waves about one cylinder; beyond them it is a sum of channels,
/// evanescent ones included. Their coefficients follow from the Bloch condition on the sides of the
/// cell and from continuity on the lines, at many points, by least squares. Neither lattice sums
/// nor copies of the cylinder are used. `misfit` is the norm of the residual.
struct GratingField {
  std::vector<Complex> transmitted, reflected;
  double misfit = 0;
};
GratingField grating_oracle(const Scatterer& cylinder, double k, const Period& period,
                            const CellChannel& light);

}  // namespace flatspeckle::wave
