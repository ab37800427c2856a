#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "flatland/media/domain.h"

namespace flatspeckle {

/// Points sorted into square cells. Neighbours within one cell size are found at constant cost.
class CellGrid {
 public:
  explicit CellGrid(double cell_size) : cell_size_(cell_size) {}

  void insert(Vec position, std::size_t number) {
    cells_[key(column(position.x), column(position.z))].push_back({position, number});
  }

  /// Calls visit(position, number) for the points within one cell size, and for some farther
  /// points, until a call returns true. Returns whether any call returned true.
  template <typename Visit>
  bool any_near(Vec position, Visit visit) const {
    const std::int64_t cx = column(position.x), cz = column(position.z);
    for (std::int64_t x = cx - 1; x <= cx + 1; ++x) {
      for (std::int64_t z = cz - 1; z <= cz + 1; ++z) {
        const auto cell = cells_.find(key(x, z));
        if (cell == cells_.end()) continue;
        for (const auto& [point, number] : cell->second)
          if (visit(point, number)) return true;
      }
    }
    return false;
  }

 private:
  struct Occupant {
    Vec position;
    std::size_t number;
  };

  /// Returns the index of the cell that contains a coordinate. All very large coordinates share one
  /// cell.
  std::int64_t column(double coordinate) const {
    constexpr double last = 1e18;
    return static_cast<std::int64_t>(std::clamp(std::floor(coordinate / cell_size_), -last, last));
  }
  static std::uint64_t key(std::int64_t x, std::int64_t z) {
    return (static_cast<std::uint64_t>(x) << 32) ^ (static_cast<std::uint64_t>(z) & 0xffffffffU);
  }

  double cell_size_;
  std::unordered_map<std::uint64_t, std::vector<Occupant>> cells_;
};

}  // namespace flatspeckle
