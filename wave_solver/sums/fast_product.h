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

/// Equally spaced point sources on a circle that radiate as the outgoing modes of one scatterer do,
/// beyond a stated distance. By Graf's theorem charges {cos, sin}(n phi) / (Q J_n(k rho)) radiate
/// H_n {cos, sin}(n phi) and orders beyond Q - n, which have died out there. By reciprocity the
/// transposed matrix takes the field on the ring to the coefficients of regular modes.
struct MultipoleRing {
  /// modes: with their weights. radius: of the disk that they belong to, 0 for a point.
  /// distance: nearest point of any other ring from the centre; errors there are below `tolerance`.
  MultipoleRing(const ModeSet& modes, double k, double radius, double distance, double tolerance);

  /// Fills `charges`, by the modes and the k that the ring was made for.
  void charge(const ModeSet& modes, double k);

  double radius = 0;             ///< of the ring, between half the disk's and all of it
  std::size_t points = 1;        ///< Q; 0 where no ring will do
  std::vector<Complex> charges;  ///< [mode][point]; real; empty until charge() is called
  double largest_charge = 0;     ///< of the modes, summed over the points; infinite without points

  Vec2 position(std::size_t point) const;  ///< relative to the centre
};

/// M x of WaveEquations by a far sum between multipole rings on a grid, and blocks for near
/// pairs: what M has more than that sum. Blocks of j < l are kept; the others are their transposes.
class RingProduct {
 public:
  /// range: of the KernelSplit; pairs of rings closer than it are near. Infinite: all pairs are,
  /// and there is no grid.
  RingProduct(const WaveEquations& system, double range, double tolerance);

  /// [column][unknown] to the same. Threaded unless called from a parallel region; the result does
  /// not depend on the number of threads.
  std::vector<Complex> operator()(std::span<const Complex> x) const;

  /// Whether rounding leaves the tolerance: not where waves are so singular, compared with the
  /// scatterer's size, that charges on a ring are far larger than what they radiate. A product that
  /// is not resolved must not be used.
  bool resolved() const { return resolved_; }

  /// What the grid must be accurate to, for rings with such charges per unit unknown.
  static double grid_tolerance(double tolerance, double largest_charge) {
    return tolerance / std::max(largest_charge, 1.0);
  }
  static constexpr double finest_grid = 1e-14;

 private:
  struct Neighbour {
    std::uint32_t body;
    bool transposed;
    std::size_t block;  // where it begins in blocks_
  };
  const MultipoleRing& ring(std::size_t body) const { return rings_[kind_[body]]; }
  std::size_t modes(std::size_t body) const { return first_[body + 1] - first_[body]; }
  void make_rings(const WaveEquations& system, double range, double tolerance);
  void find_neighbours(std::span<const WaveEquations::Body> bodies, double range);
  std::vector<Vec2> place_rings(std::span<const WaveEquations::Body> bodies, double range);
  void fill(const WaveEquations& system, std::size_t row, const Neighbour& column,
            const std::optional<KernelSplit>& split);
  void subtract_far(std::span<const WaveEquations::Body> bodies, std::size_t row,
                    const Neighbour& column, const KernelSplit& split);

  std::vector<std::size_t> first_;  // unknown of each body, and their number
  std::vector<std::uint32_t> kind_;
  std::vector<MultipoleRing> rings_;
  std::vector<std::size_t> ring_first_;  // point of each body's ring
  std::size_t ring_points_ = 0;
  std::vector<std::vector<Neighbour>> neighbours_;
  std::vector<Complex> blocks_;
  std::optional<GridSum> far_;
  bool resolved_ = true;
};

class HelmholtzSum;
class RingProduct;

/// y = M x of WaveEquations in nearly linear time: point scatterers by a HelmholtzSum, others by
/// a RingProduct, and small systems, or such whose waves are too singular for a grid, block by
/// block. Shares no sum with WaveEquations::apply beyond near blocks, whose oracle that is. The
/// error is below `tolerance` of ||M x||, from 1e-12 on.
class FastProduct {
 public:
  /// Keeps a reference to the system.
  FastProduct(const WaveEquations& system, double tolerance);
  ~FastProduct();

  /// [column][unknown] to the same. Threaded unless called from a parallel region; the result does
  /// not depend on the number of threads.
  std::vector<Complex> operator()(std::span<const Complex> x) const;

 private:
  std::vector<Complex> sum_over_points(std::span<const Complex> x) const;

  const WaveEquations& system_;
  std::unique_ptr<const HelmholtzSum> points_;
  std::vector<double> sigma_;  // of points
  std::unique_ptr<const RingProduct> rings_;
};

}  // namespace flatspeckle::wave
