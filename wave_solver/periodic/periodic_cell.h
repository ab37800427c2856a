#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/placement/placement.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/periodic/image_waves.h"
#include "wave_solver/solutions/equation_solver.h"

namespace flatspeckle::wave {

/// Bloch condition u(x + width, z) = e^{i phase} u(x, z).
struct Period {
  double width = 0, phase = 0;
};

/// A propagating channel: a plane wave with k_x = (2 pi number + phase) / width.
struct CellChannel {
  int number = 0;
  double sine = 0, cosine = 0;  ///< k_x / k and |k_z| / k
};

/// Returns the propagating channels in the order of k_x. A channel at its Wood anomaly (k_z = 0)
/// carries no power and is not included.
std::vector<CellChannel> channels_of(double k, const Period& period);

/// Copies of a region along x: near ones, which are part of the equations like the scatterers
/// themselves, and waves from all others.
struct CellImages {
  Period period;
  Copies near;
  /// Waves from the copies on the right. Those from the left are the same, with exchanged roles, if
  /// Copies::symmetric(); if not, they belong to the opposite phase and are the second ones.
  std::vector<ImageWaves> waves;
};
/// region: rectangle that contains the scatterers. tolerance: accuracy of the waves.
CellImages cell_images(double k, const Period& period, const Rectangle& region, double tolerance);

/// The multiple-scattering equations of a placement that repeats along x. Near copies of the
/// scatterers are part of M_near. The other copies are included through ImageWaves, M = M_near +
/// sum U C V^T. Channels close to grazing are not part of M; solve() includes them as additional
/// unknowns, so that its result is finite at Wood anomalies.
class PeriodicCell {
 public:
  /// placement: lies in the region of the images, which must exist longer than this object.
  /// tolerance: accuracy of the solution. Throws InputError for scatterers that overlap with each
  /// other or with a copy.
  PeriodicCell(const Placement& placement, double k, const CellImages& images, double tolerance);

  const TMatrixSystem& near() const { return near_; }
  const Period& period() const { return images_.period; }
  std::size_t unknowns() const { return near_.unknowns(); }
  bool symmetric() const { return near_.copies().symmetric(); }
  /// M without grazing channels; refers to this object.
  SolvableEquations equations() const;

  /// Solves for right-hand sides [column][unknown].
  std::vector<Complex> solve(EquationSolver& solver, std::vector<Complex> rhs) const;

  /// Returns the right-hand sides for unit plane waves (phase origin r = 0): [wave][unknown].
  std::vector<Complex> right_hand_sides(std::span<const WaveDirection> waves) const;
  /// Returns the contribution of each unknown to the amplitude of the outgoing plane waves along
  /// these directions, times their |k_z|: [wave][unknown].
  std::vector<Complex> outgoing_rows(std::span<const WaveDirection> waves) const;

 private:
  // Sum of U C V^T over one or both directions along x. U and V: [wave][unknown].
  struct Far {
    const std::vector<Complex>*received, *sent, *coupling;
  };
  std::vector<Far> far() const;
  void add_far(std::span<const Complex> x, std::span<Complex> y) const;
  Entries matrix() const;
  BlockMap product(double tolerance) const;
  BlockMap inverse(double tolerance) const;

  const CellImages& images_;
  TMatrixSystem near_;
  // For each of the ImageWaves: w and -w, evaluated for all unknowns.
  std::vector<std::vector<Complex>> towards_, away_;
};

}  // namespace flatspeckle::wave
