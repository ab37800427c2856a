#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "wave_solver/equations/multipole_ring.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

/// The scattered field of a solution at many points: rings of point sources (multipole_ring.h)
/// stand for the scatterers wherever a point is beyond a clearance from their centres, so that a
/// HelmholtzSum serves; nearer points are corrected one by one.
class RingField {
 public:
  /// tolerance: of the field, relative to its size; from 1e-12 on. area_per_point: how densely the
  /// points will lie, which decides the clearances.
  RingField(const WaveSolution& solution, double tolerance, double area_per_point);

  /// False where rings for this tolerance would need too large charges.
  bool resolved() const { return largest_charge_ * smallest_tolerance < tolerance_; }
  double clearance(std::size_t scatterer) const { return ring(scatterer).clearance; }
  std::size_t sources() const { return positions_.size(); }

  /// Field of all rings, [light][point]; none where the points are so few that a sum over all pairs
  /// would be faster.
  std::optional<std::vector<Complex>> sum(std::span<const Vec2> points) const;
  /// What a scatterer's own waves have more than its ring: [light][point].
  std::vector<Complex> correction(std::size_t scatterer, std::span<const Vec2> points) const;

 private:
  static constexpr double smallest_tolerance = 1e-14;
  struct ClearedRing {
    MultipoleRing ring;
    double clearance;
  };
  const ClearedRing& ring(std::size_t scatterer) const { return rings_[kind_[scatterer]]; }
  void find_kinds(std::vector<std::size_t>& examples);
  ClearedRing best_ring(std::size_t scatterer, double area_per_point) const;
  void place_rings();

  const WaveSolution& solution_;
  double tolerance_, largest_charge_ = 1;
  std::vector<std::uint32_t> kind_;
  std::vector<ClearedRing> rings_;
  std::vector<std::size_t> first_;  // position of each scatterer's ring
  std::vector<Vec2> positions_;
  std::vector<Complex> charges_;  // [light][position]
};

/// Scattered field of one scatterer at points outside it, added to field, [light][point].
void add_scattered(const WaveSolution& solution, std::size_t scatterer,
                   std::span<const Vec2> points, std::span<Complex> field);

}  // namespace flatspeckle::wave
