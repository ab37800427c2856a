#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "flatland/media/domain.h"

namespace flatspeckle {

/// Points sorted into square cells, in space into cubes. Neighbours within one cell size are found
/// at constant cost.
class CellGrid {
 public:
  explicit CellGrid(double cell_size) : cell_size_(cell_size) {}

  void insert(Vec position, std::size_t number) {
    const std::int64_t y = column(position.y);
    low_y_ = std::min(low_y_, y);
    high_y_ = std::max(high_y_, y);
    cells_[key(column(position.x), column(position.z), y)].push_back({position, number});
  }

  /// Calls visit(position, number) for the points within one cell size, and for some farther
  /// points, until a call returns true. Returns whether any call returned true.
  template <typename Visit>
  bool any_near(Vec position, Visit visit) const {
    const std::int64_t cx = column(position.x), cz = column(position.z), cy = column(position.y);
    for (std::int64_t y = std::max(cy - 1, low_y_); y <= std::min(cy + 1, high_y_); ++y)
      for (std::int64_t x = cx - 1; x <= cx + 1; ++x)
        for (std::int64_t z = cz - 1; z <= cz + 1; ++z)
          if (any_in(key(x, z, y), visit)) return true;
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
  /// In the plane the key is unique. In space different cells may share one, which only adds points
  /// to visit.
  static std::uint64_t key(std::int64_t x, std::int64_t z, std::int64_t y) {
    constexpr std::uint64_t odd = 0x9e3779b97f4a7c15U;
    return ((static_cast<std::uint64_t>(x) << 32) ^ (static_cast<std::uint64_t>(z) & 0xffffffffU)) +
           odd * static_cast<std::uint64_t>(y);
  }

  template <typename Visit>
  bool any_in(std::uint64_t cell_key, Visit& visit) const {
    const auto cell = cells_.find(cell_key);
    if (cell == cells_.end()) return false;
    for (const auto& [point, number] : cell->second)
      if (visit(point, number)) return true;
    return false;
  }

  double cell_size_;
  std::int64_t low_y_ = std::numeric_limits<std::int64_t>::max(),
               high_y_ = std::numeric_limits<std::int64_t>::min();  // occupied layers of cells
  std::unordered_map<std::uint64_t, std::vector<Occupant>> cells_;
};

}  // namespace flatspeckle
