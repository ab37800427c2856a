#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin::design {

/// Where a straight ray comes into a ball or a box and leaves it again, as lengths along a unit
/// direction. Nothing where it misses.
inline std::optional<std::pair<double, double>> passage(const Sphere& ball, const Vec3& x,
                                                        const Vec3& along) {
  const Vec3 r = x - ball.centre;
  const double b = r.dot(along), square = b * b - r.squaredNorm() + ball.radius * ball.radius;
  if (!(square > 0)) return std::nullopt;
  return std::pair(-b - std::sqrt(square), -b + std::sqrt(square));
}
inline std::optional<std::pair<double, double>> passage(const Box& box, const Vec3& x,
                                                        const Vec3& along) {
  double in = -HUGE_VAL, out = HUGE_VAL;
  for (int a = 0; a < 3; ++a) {
    const auto [near, far] =
        std::minmax({(box.low[a] - x[a]) / along[a], (box.high[a] - x[a]) / along[a]});
    if (along[a] == 0) {
      if (x[a] < box.low[a] || x[a] > box.high[a]) return std::nullopt;
      continue;
    }
    in = std::max(in, near);
    out = std::min(out, far);
  }
  if (!(in < out)) return std::nullopt;
  return std::pair(in, out);
}
inline std::optional<std::pair<double, double>> passage(const Surface& hull, const Vec3& x,
                                                        const Vec3& along) {
  if (const auto* ball = std::get_if<Sphere>(&hull)) return passage(*ball, x, along);
  if (const auto* box = std::get_if<Box>(&hull)) return passage(*box, x, along);
  return std::nullopt;
}

}  // namespace flatspeckle::grin::design
