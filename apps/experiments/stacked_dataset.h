#pragma once

#include <vector>

#include "core/result/collected_result.h"

namespace flatspeckle::apps {

/// What all points of a sweep have, in one dataset with the axes of the sweep in front. Values come
/// point by point, in the order of the points, and are written by whole chunks of some 64 kB: no
/// more than that is in memory, or one point's.
class StackedDataset {
 public:
  using Held = CollectedDataset::Held;

  /// of_point: its axes are those of each point; its values say their kind and number alone.
  /// grid: the axes of the sweep, with scales; extents: how long they are.
  StackedDataset(ResultFile& file, const CollectedDataset& of_point, const std::vector<Axis>& grid,
                 const std::vector<std::size_t>& extents);

  /// Of the next point.
  void add(const Held& values);
  void add(double value) { add(std::vector{value}); }
  /// The next point has none: 0.
  void add_none();

 private:
  std::vector<std::size_t> start() const;
  std::vector<std::size_t> count(const std::vector<std::size_t>& start) const;

  ResultFile& file_;
  std::string name_;
  std::vector<std::size_t> extents_, chunk_;
  std::size_t of_each_;
  std::size_t points_ = 0, waiting_points_ = 0;  ///< that are written, and that are not yet
  Held waiting_;
};

}  // namespace flatspeckle::apps
