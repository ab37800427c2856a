#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "apps/sweep/sweep_points.h"

namespace flatspeckle::apps {

/// The numbers of points by their names. Of ranges it holds nothing.
class PointFinder {
 public:
  /// The points must live as long.
  explicit PointFinder(const SweepPoints& points);

  /// Nothing of a name that is no point's.
  std::optional<std::size_t> find(const std::string& name) const;

 private:
  using Numbers = std::unordered_map<std::string, std::size_t>;

  std::optional<std::size_t> on_grid(const std::string& name) const;
  std::optional<std::size_t> on_axis(std::size_t axis, const std::string& value) const;

  const SweepPoints& points_;
  Numbers rows_;                 ///< of a list, by their names
  std::vector<Numbers> values_;  ///< of each axis of a grid; none of a range
};

}  // namespace flatspeckle::apps
