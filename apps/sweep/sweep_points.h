#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/sweep/axis_values.h"
#include "core/keys/keys.h"

namespace flatspeckle::apps {

/// A key that a sweep varies, and its values.
struct SweepAxis {
  std::string key;
  AxisValues values;
};

/// The points of a sweep: the product of its axes, last axis fastest, or the rows of a list.
struct SweepPoints {
  std::vector<SweepAxis> axes;  ///< in the order of the result; of a list a value for each row
  bool is_list = false;

  std::size_t count() const;
  std::string value(std::size_t axis, std::size_t point) const;
  /// "g=0.5_albedo=1": a name for files.
  std::string name(std::size_t point) const;
  /// Sets the keys of a point.
  void set(std::size_t point, const Keys& keys) const;
};

/// Lists of values as given on the command line, by key, and a table of points.
struct SweepLists {
  std::vector<std::string> keys;  ///< that may be swept, in the order of the result's axes
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::vector<std::string>> texts;  ///< complex numbers
  std::string points;
};
/// Puts lists in the place of the keys that may be swept.
void add_sweep_keys(Keys& keys, SweepLists& lists);

/// Throws InputError for a table without rows, with columns that are no keys of a sweep or lists
/// beside it, and for a point that comes twice.
SweepPoints sweep_points(const Keys& keys, const SweepLists& lists);

}  // namespace flatspeckle::apps
