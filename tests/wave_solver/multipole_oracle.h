#pragma once

#include <vector>

#include "reference.h"

namespace flatspeckle::wave {

/// Reference solution of disks in a plane wave by multipoles (C6, C7, C10) of given orders, with a
/// dense unscaled matrix. The unknowns are b_n H_n(k a), the scattered waves on a disk's own rim,
/// for n = -order .. order; the equation of order n is multiplied by J_n(k a). Real indices only.
class MultipoleOracle {
 public:
  MultipoleOracle(const Placement& placement, double k, double light, std::vector<int> orders);

  /// Total field inside a penetrable disk, up to its rim.
  Complex inside(std::size_t disk, Vec point) const;
  Complex outside(Vec point) const;

 private:
  std::size_t place(std::size_t disk, int n) const {
    return first_[disk] + static_cast<std::size_t>(n + orders_[disk]);
  }
  void own_block(std::size_t disk, std::vector<Complex>& matrix);
  void block(std::size_t to, std::size_t from, std::vector<Complex>& matrix) const;

  Placement placement_;
  double k_, light_;
  std::vector<int> orders_;
  std::vector<std::size_t> first_;
  std::vector<Complex> on_rim_;
};

}  // namespace flatspeckle::wave
