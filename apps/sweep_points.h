#pragma once

#include <string>
#include <vector>

#include "apps/command_line.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::apps {

/// A key that a sweep may vary, and its values, as text that reads back as the same numbers.
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
  SceneSpec scene(SceneSpec base, const SweepPoint& point) const;
};

/// The keys that a sweep may vary, in the order of the result's axes.
const std::vector<std::string>& sweep_keys();

/// Lists of values as given on the command line, and a table of points.
struct SweepLists {
  std::vector<double> density, radius, optical_depth, g, albedo;
  std::vector<std::string> index;
  std::string points;
};
/// Adds those keys; there must be none of them yet.
void add_sweep_options(Options& options, SweepLists& lists);

/// Throws InputError for a table without rows, with columns that are no keys of a sweep or lists
/// beside it, and for a point that comes twice.
SweepPoints sweep_points(const SweepLists& lists);

}  // namespace flatspeckle::apps
