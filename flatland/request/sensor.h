#pragma once

#include <compare>
#include <string>
#include <vector>

#include "flatland/media/domain.h"

namespace flatspeckle {

/// What records the field: a direction far away (amplitude A of C4) or a point (the scattered
/// field).
struct View {
  bool near = false;
  double angle = 0;  ///< far view
  Vec2 point;        ///< near sensor
  auto operator<=>(const View&) const = default;
};

inline View far_view(double angle) {
  return {false, angle, {}};
}
inline std::vector<View> far_views(const std::vector<double>& angles) {
  std::vector<View> views;
  for (double angle : angles) views.push_back(far_view(angle));
  return views;
}
inline View near_sensor(Vec2 point) {
  return {true, 0, point};
}

/// Reads columns x, z; at least one row. Throws InputError.
std::vector<Vec2> read_points(const std::string& path);

}  // namespace flatspeckle
