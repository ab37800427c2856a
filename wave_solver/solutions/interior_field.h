#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "wave_solver/equations/rim_waves.h"
#include "wave_solver/equations/t_matrix_system.h"

namespace flatspeckle::wave {

/// Whether a scatterer is not there at all: every T_n is 0 (index 1).
bool is_transparent(const TMatrixSystem& system, std::size_t scatterer);

/// The whole field at points inside a disk of kind tm or te, for a unit unknown of each of its
/// modes: rows are points, columns modes. Not for transparent disks.
void field_inside(const TMatrixSystem& system, std::size_t disk, std::span<const Vec2> points,
                  Target out);

}  // namespace flatspeckle::wave
