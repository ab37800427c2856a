#pragma once

#include <cmath>
#include <numbers>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin::design {

// Points that fill a shape evenly, numbered, without a random number.

inline constexpr double golden_ratio = 0.61803398874989485;
inline constexpr double golden_angle = 2 * std::numbers::pi * (1 - golden_ratio);

/// The i-th of so many numbers from 0 to 1.
inline double even_share(int i, int count) {
  return (i + 0.5) / count;
}

/// The i-th of so many directions all around.
inline Vec3 even_direction(int i, int count, double turn) {
  const double z = 1 - 2 * even_share(i, count), rho = std::sqrt(1 - z * z);
  const double azimuth = golden_angle * i + turn;
  return {rho * std::cos(azimuth), rho * std::sin(azimuth), z};
}

/// The i-th of so many points of a unit disk; those of another turn lie between.
inline Eigen::Vector2d even_point(int i, int count, double turn) {
  const double within = std::fmod(0.5 + golden_ratio * turn, 1);
  const double rho = std::sqrt((i + within) / count), azimuth = golden_angle * i + turn;
  return {rho * std::cos(azimuth), rho * std::sin(azimuth)};
}

}  // namespace flatspeckle::grin::design
