#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "wave_solver/equations/cylinder_waves.h"
#include "wave_solver/equations/wave_equations.h"
#include "wave_solver/sums/grid_sum.h"

namespace flatspeckle::wave {

/// Q equally spaced point sources on a circle of radius rho, which radiate the outgoing modes of
/// one scatterer beyond a given distance. By Graf's theorem charges {cos, sin}(n phi) / (Q J_n(k
/// rho)) radiate H_n {cos, sin}(n phi) and spurious waves of orders Q - n and higher, which are
/// negligible beyond that distance. By reciprocity the transposed matrix of charges maps the field
/// on the ring to the coefficients of regular modes.
struct MultipoleRing {
  /// modes: the modes of the scatterer, with their weights. radius: radius of the disk, 0 for a
  /// point. distance: distance from the centre beyond which errors are below `tolerance`; all
  /// points of other rings must lie beyond it.
  MultipoleRing(const ModeSet& modes, double k, double radius, double distance, double tolerance);

  /// Fills `charges`; modes and k must be those of the constructor.
  void charge(const ModeSet& modes, double k);

  double radius = 0;             ///< rho, between half the radius of the disk and its radius
  std::size_t points = 1;        ///< Q; 0 if no ring is suitable
  std::vector<Complex> charges;  ///< [mode][point]; real; empty until charge() is called
  double largest_charge = 0;     ///< largest summed_charges() of a mode; infinite if points = 0

  Vec position(std::size_t point) const;  ///< relative to the centre of the ring
};

/// Product M x of WaveEquations, as the sum of two parts: a far sum between multipole rings on a
/// grid and, for near pairs of bodies, blocks that contain the difference between M and that sum.
/// Only one of the two blocks of a pair is stored; the other is its transpose.
class RingProduct {
 public:
  /// range: range of the KernelSplit. Two rings are a near pair if they are closer to each other
  /// than this. If the range is infinite, all pairs are near and no grid is used.
  RingProduct(const WaveEquations& system, double range, double tolerance);

  /// Returns M x, both [column][unknown]. Threaded unless called from a parallel region; the result
  /// does not depend on the number of threads.
  std::vector<Complex> operator()(std::span<const Complex> x) const;

  /// Whether rounding errors are below the tolerance; if not, the product must not be used.
  /// Rounding errors exceed the tolerance if the waves of a scatterer are so singular at its size
  /// that the charges on its ring are far larger than the field that they radiate.
  bool resolved() const { return resolved_; }

  /// Returns the required accuracy of the grid for rings with the given
  /// MultipoleRing::largest_charge.
  static double grid_tolerance(double tolerance, double largest_charge) {
    return tolerance / std::max(largest_charge, 1.0);
  }
  static constexpr double finest_grid = 1e-14;

 private:
  struct Neighbour {
    std::uint32_t body;
    bool transposed;
    std::size_t block;  // offset in blocks_
  };
  const MultipoleRing& ring(std::size_t body) const { return rings_[kind_[body]]; }
  std::size_t modes(std::size_t body) const { return first_[body + 1] - first_[body]; }
  void make_rings(const WaveEquations& system, double range, double tolerance);
  void find_neighbours(std::span<const WaveEquations::Body> bodies, double range);
  std::vector<Vec> place_rings(std::span<const WaveEquations::Body> bodies, double range);
  void fill(const WaveEquations& system, std::size_t row, const Neighbour& column,
            const std::optional<KernelSplit>& split);
  void subtract_far(std::span<const WaveEquations::Body> bodies, std::size_t row,
                    const Neighbour& column, const KernelSplit& split);

  std::vector<std::size_t> first_;  // first unknown of each body, then the number of unknowns
  std::vector<std::uint32_t> kind_;
  std::vector<MultipoleRing> rings_;
  std::vector<std::size_t> ring_first_;  // first point of each body's ring
  std::size_t ring_points_ = 0;
  std::vector<std::vector<Neighbour>> neighbours_;
  std::vector<Complex> blocks_;
  std::optional<GridSum> far_;
  bool resolved_ = true;
};

class HelmholtzSum;
class RingProduct;

/// Product y = M x of WaveEquations in nearly linear time. Systems of points use a HelmholtzSum,
/// other systems a RingProduct. Small systems, and systems whose waves are too singular for a grid,
/// are multiplied block by block. Except for near blocks, no code is shared with
/// WaveEquations::apply(), which therefore serves as an independent reference in tests. The error
/// is below `tolerance` times ||M x||, for tolerances from 1e-12 on.
class FastProduct {
 public:
  /// Keeps a reference to the system.
  FastProduct(const WaveEquations& system, double tolerance);
  ~FastProduct();

  /// Returns M x, both [column][unknown]. Threaded unless called from a parallel region; the result
  /// does not depend on the number of threads.
  std::vector<Complex> operator()(std::span<const Complex> x) const;

 private:
  std::vector<Complex> sum_over_points(std::span<const Complex> x) const;

  const WaveEquations& system_;
  std::unique_ptr<const HelmholtzSum> points_;
  std::vector<double> sigma_;  // sigma of each point (WaveEquations)
  std::unique_ptr<const RingProduct> rings_;
};

}  // namespace flatspeckle::wave
