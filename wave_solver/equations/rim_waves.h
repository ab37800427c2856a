#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle::wave {

/// What one order of a penetrable disk adds, for a unit unknown (t_matrix_system.h) and but for its
/// angle, at the rim.
struct RimWave {
  ExtendedComplex field;  ///< u
  ExtendedComplex slope;  ///< du/dr / k that the outside must have: q / m of that inside (C7)
};

/// Of n = 0 .. order of a disk of kind tm or te. The wave inside follows from continuity of u and
/// the slope: with D = J_n'(mx) / J_n(mx), sigma / T_n times -(2i / pi x) / (q D H_n(x) - H_n'(x)).
std::vector<RimWave> rim_waves(const Scatterer& cylinder, double k, int order);

}  // namespace flatspeckle::wave
