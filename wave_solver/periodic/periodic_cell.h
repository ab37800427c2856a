#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/placement/placement.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/maps/field_map.h"
#include "wave_solver/periodic/image_waves.h"
#include "wave_solver/skeletons/fast_direct.h"
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
  /// other or with a copy. sensors: points at which the field will be evaluated.
  PeriodicCell(const Placement& placement, double k, const CellImages& images, double tolerance,
               std::span<const Vec> sensors = {});

  const TMatrixSystem& near() const { return near_; }
  const Period& period() const { return images_.period; }
  std::size_t unknowns() const { return near_.unknowns(); }
  bool symmetric() const { return near_.copies().symmetric(); }
  /// M without grazing channels; refers to this object.
  SolvableEquations equations() const;

  /// A solver of M, without grazing channels, for columns over some of the unknowns.
  struct Solver {
    std::vector<std::size_t> unknowns;
    BlockMap solve;
  };
  /// Returns a solver for the unknowns that represent all others in waves to and from the outside
  /// of the slab. Products of right_hand_sides() and outgoing_rows() with its solutions agree with
  /// those over all unknowns up to about the tolerance. Factors of boxes are not stored.
  Solver reduced(double tolerance) const;
  Solver whole(EquationSolver& solver) const;

  struct Solution {
    std::vector<Complex> x;        ///< [column][unknown]
    std::vector<Complex> grazing;  ///< amplitudes of the grazing channels: [column][side]
  };
  /// Solves, with grazing channels, for right-hand sides over the unknowns of the solver.
  Solution solve(const Solver& solver, std::vector<Complex> rhs) const;

  /// Returns the right-hand side for a sum of plane waves.
  std::vector<Complex> right_hand_side(std::span<const PlaneWave> waves) const;
  /// Returns the waves from the images to the region, for a column of a solution over all unknowns.
  std::vector<PlaneWave> image_field(const Solution& solution, std::size_t column) const;

  /// Returns the right-hand sides for unit plane waves (phase origin r = 0) and some of the
  /// unknowns: [wave][unknown].
  std::vector<Complex> right_hand_sides(std::span<const WaveDirection> waves,
                                        std::span<const std::size_t> unknowns) const;
  /// Returns the contribution of unknowns to the amplitude of the outgoing plane waves along these
  /// directions, times their |k_z|: [wave][unknown].
  std::vector<Complex> outgoing_rows(std::span<const WaveDirection> waves,
                                     std::span<const std::size_t> unknowns) const;

 private:
  // Sum of U C V^T over both directions along x, for some of the unknowns. U and V are w or -w of
  // the ImageWaves: [wave][unknown].
  struct Far {
    std::vector<std::vector<Complex>> towards, away;
  };
  Far far(std::span<const std::size_t> unknowns) const;
  // Adds the sum, as a matrix over these unknowns.
  void add_far(std::span<const std::size_t> unknowns, Complex* matrix) const;
  Entries matrix() const;
  BlockMap product(const std::shared_ptr<const TMatrixSystem>& all, double tolerance) const;
  FastDirect factored(const TMatrixSystem& all, double tolerance, bool solves) const;
  std::vector<std::size_t> all_unknowns() const;

  const CellImages& images_;
  TMatrixSystem near_;
};

}  // namespace flatspeckle::wave
