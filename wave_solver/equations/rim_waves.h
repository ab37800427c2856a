#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scatterers/scatterer.h"
#include "wave_solver/equations/t_matrix_system.h"

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

/// Whether a scatterer is not there at all: every T_n is 0 (index 1).
bool is_transparent(const TMatrixSystem& system, std::size_t scatterer);

/// The whole field at points inside a disk of kind tm or te, for a unit unknown of each of its
/// modes: rows are points, columns modes. Not for transparent disks.
void field_inside(const TMatrixSystem& system, std::size_t disk, std::span<const Vec2> points,
                  Target out);

}  // namespace flatspeckle::wave
