#pragma once

#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

/// How well the boundary conditions hold, relative to the unit incident waves: the largest mismatch
/// over points on the rims of the disks with the smallest gaps and over all lights. Soft: |u|;
/// hard: |du/dr| / k; penetrable: the jumps of u and of du/dr / k (m^-2 du/dr for TE) across the
/// rim. The field outside is summed directly from all scatterers, not through translations, so that
/// it sees a basis order that is too low, which neither the equations' residual nor the optical
/// theorem does. 0 without disks. It is a local, first-order measure: a truncation that changes far
/// fields by eps leaves about sqrt(eps) in the narrowest gap.
double boundary_residual(const WaveSolution& solution);

}  // namespace flatspeckle::wave
