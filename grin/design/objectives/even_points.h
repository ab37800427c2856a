#pragma once

#include <cmath>
#include <numbers>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin::design {

// Deterministic points, evenly distributed over a shape. The i-th of `count` points is computed
// from i.

inline constexpr double golden_ratio = 0.61803398874989485;
inline constexpr double golden_angle = 2 * std::numbers::pi * (1 - golden_ratio);

/// Returns the i-th of `count` evenly spaced numbers in (0, 1).
inline double even_share(int i, int count) {
  return (i + 0.5) / count;
}

/// Returns the i-th of `count` directions over the full sphere; `turn` rotates them about z.
inline Vec3 even_direction(int i, int count, double turn) {
  const double z = 1 - 2 * even_share(i, count), rho = std::sqrt(1 - z * z);
  const double azimuth = golden_angle * i + turn;
  return {rho * std::cos(azimuth), rho * std::sin(azimuth), z};
}

/// Returns the i-th of `count` points of the unit disk. A different `turn` gives other points,
/// which lie between the first ones.
inline Eigen::Vector2d even_point(int i, int count, double turn) {
  const double within = std::fmod(0.5 + golden_ratio * turn, 1);
  const double rho = std::sqrt((i + within) / count), azimuth = golden_angle * i + turn;
  return {rho * std::cos(azimuth), rho * std::sin(azimuth)};
}

}  // namespace flatspeckle::grin::design
