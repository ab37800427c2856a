#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/placement/placement.h"
#include "wave_solver/equations/wave_equations.h"

namespace flatspeckle::wave {

/// The multiple-scattering equations of one placement, with sigma_n = sqrt|T_n|: the diagonal is
/// -|T_n|/T_n, and 1 where T_n = 0. Entries are of moderate size however many orders T_n and S span
/// (C11).
class TMatrixSystem : public WaveEquations {
 public:
  /// Orders follow from the tolerance (basis_order.h). sensors: where the near field will be
  /// wanted. Throws InputError for scatterers without a T-matrix or disks too close to be resolved.
  TMatrixSystem(Placement placement, double k, double tolerance,
                std::span<const Vec2> sensors = {});

  const Placement& placement() const { return placement_; }
  /// T_n for n = 0 .. order.
  std::span<const ExtendedComplex> t_matrix(std::size_t scatterer) const { return t_[scatterer]; }

  /// -sigma a of a point source, the Green function (C3); by reciprocity -i/4 of outside_row().
  /// Throws InputError for a source inside a disk or on a point scatterer.
  std::vector<Complex> source_side(Vec2 source) const;

 private:
  Placement placement_;
  std::vector<std::vector<ExtendedComplex>> t_;
};

}  // namespace flatspeckle::wave
