#pragma once

#include <string>
#include <vector>

#include "apps/sweep/sweep_points.h"
#include "core/search/noisy_search.h"

namespace flatspeckle::apps {

/// A key that is searched over: between two bounds, or one of some values.
struct SearchAxis {
  std::string key;
  double low = 0, high = 0;
  bool is_log = false;
  std::vector<std::string> values = {};  ///< empty: between the bounds

  bool is_choice() const { return !values.empty(); }
  /// From 0 to 2 pi or -pi to pi, as of a phase: the bounds are the same place.
  bool is_turn() const;
};

/// What is searched: places of the search, and the values of keys that they stand for.
class SearchAxes {
 public:
  /// Of "key=low:high", "key=low:high:log" and of what a sweep takes: "key=1,2,3" or words. Keys of
  /// `of`. Throws InputError.
  SearchAxes(const std::vector<std::string>& vary, const Keys& of);

  const std::vector<SearchAxis>& axes() const { return axes_; }
  /// Of keys between bounds, and of combinations of the others.
  std::size_t dimensions() const;
  std::size_t choices() const;

  /// The values of the keys there, one for each axis.
  SweepPoints point(const SearchPlace& place) const;
  /// Keys that are there at a bound of theirs, by no more than this share of their range; not
  /// phases, which have none.
  std::vector<std::string> at_bounds(const SearchPlace& place, double tolerance) const;

 private:
  std::vector<SearchAxis> axes_;
};

}  // namespace flatspeckle::apps
