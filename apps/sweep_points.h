#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/keys/keys.h"

namespace flatspeckle::apps {

/// A key that a sweep varies, and its values, as text that reads back as the same numbers.
struct SweepAxis {
  std::string key;
  std::vector<std::string> values;
};

/// What one point sets, axis by axis.
struct SweepPoint {
  std::vector<std::string> values;
};

/// The points of a sweep: the product of its axes, last axis fastest, or the rows of a list.
struct SweepPoints {
  std::vector<SweepAxis> axes;  ///< with a value at least, in the order of the result
  std::vector<SweepPoint> points;
  bool is_list = false;

  /// "g=0.5_albedo=1": a name for files.
  std::string name(const SweepPoint& point) const;
  /// Sets the keys of a point.
  void set(const SweepPoint& point, const Keys& keys) const;
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
