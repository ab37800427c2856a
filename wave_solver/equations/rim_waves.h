#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scatterers/scatterer.h"
#include "wave_solver/equations/t_matrix_system.h"

namespace flatspeckle::wave {

/// Total field at the rim of a penetrable disk if one unknown beta_n of the disk (TMatrixSystem) is
/// 1 and its other unknowns are 0. The angular factor, such as sqrt(2) cos(n phi), is left out.
struct RimWave {
  ExtendedComplex field;  ///< field u at the rim
  /// du/dr / k just outside the rim. Just inside the rim it is m / q times this value (C7).
  ExtendedComplex derivative;
};

/// Returns the rim waves of orders n = 0 .. order of a disk of kind tm or te, or of a penetrable
/// sphere (whose Wronskian is -i / x^2 instead of -2i / (pi x)). From the continuity
/// of u and of the derivative (C7), u = (sigma / T_n) (-2i / (pi x)) / (q D H_n(x) - H_n'(x)) with
/// sigma = sqrt|T_n|, x = k radius, D = J_n'(mx) / J_n(mx), and m, q and H_n of C7.
std::vector<RimWave> rim_waves(const Scatterer& scatterer, double k, int order,
                               Radial kind = Radial::cylindrical);

/// Whether a scatterer has no effect at all: every T_n is 0 (index 1).
bool is_transparent(const TMatrixSystem& system, std::size_t scatterer);

/// Evaluates the total field at points inside a disk of kind tm or te. Rows are points; a column is
/// the field if the unknown of one mode of the disk is 1 and its other unknowns are 0.
/// Precondition: the disk is not transparent.
void field_inside(const TMatrixSystem& system, std::size_t disk, std::span<const Vec> points,
                  Target out);

}  // namespace flatspeckle::wave
