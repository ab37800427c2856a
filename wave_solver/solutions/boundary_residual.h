#pragma once

#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

/// Returns the largest violation of the boundary conditions, relative to the unit incident waves,
/// over points on the rims of the disks with the smallest gaps and over all lights. The violation
/// is |u| for soft disks, |du/dr| / k for hard disks, and the jump of u or of du/dr / k (m^-2 du/dr
/// for TE) across the rim of penetrable disks. The field outside is summed directly from all
/// scatterers, not through translations, so that a basis order that is too low shows here, unlike
/// in the residual of the equations or the optical theorem. Returns 0 if there are no disks. The
/// residual is a local, first-order measure: a truncation that changes far fields by eps leaves a
/// residual of about sqrt(eps) in the narrowest gap.
double boundary_residual(const WaveSolution& solution);

}  // namespace flatspeckle::wave
