#pragma once

#include "core/result/invariant.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

/// |extinction - scattering - absorption| of the whole placement over its extinction, the worst of
/// a few lights. Extinction is that of the forward amplitude (C9), scattering the integral of |A|^2
/// over all directions, and absorption the flux through the rims of absorbing disks in terms of the
/// waves inside (rim_waves.h); none of disks and points that do not absorb. It holds at any basis
/// order. The limit is what rounding and the residual of the equations explain. tolerance: of the
/// solution, which many lights are combined to.
Invariant power_balance(const WaveSolution& solution, double tolerance);

}  // namespace flatspeckle::wave
