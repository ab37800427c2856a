#pragma once

#include "core/result/invariant.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

/// Returns, for each unknown, the power that its scatterer absorbs if the unknown has the absolute
/// value 1.
std::vector<double> absorption_of(const TMatrixSystem& system);

/// Returns |extinction - scattering - absorption| / extinction of the whole placement: the largest
/// value over a few of the lights. Extinction follows from the forward amplitude (C9). Scattering
/// is the integral of |A|^2 over all directions. Absorption is the power absorbed by points, plus
/// the flux through the rims of absorbing disks, which follows from the waves inside (rim_waves.h).
/// The balance holds at any basis order. The limit of the Invariant is the imbalance that rounding
/// and the residual of the equations explain. tolerance: tolerance of the solution, which also
/// limits the error of a LightBasis.
Invariant power_balance(const WaveSolution& solution, double tolerance);

}  // namespace flatspeckle::wave
