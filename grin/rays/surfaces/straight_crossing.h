#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "grin/rays/surfaces/lens.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

// Distance that a straight ray goes from x along the unit vector d until it leaves a surface
// (exit_distance; x is inside) or enters it (entry_distance; x is outside; infinity if it does
// not). A point that is on the surface within rounding counts as inside for exit_distance and as
// outside for entry_distance, so that a ray does not meet the surface again that it has just
// passed.

inline constexpr double no_crossing = std::numeric_limits<double>::infinity();

/// Returns the accuracy of the crossing of a line with a surface at coordinates of this size.
inline double crossing_accuracy(double coordinate) {
  return 32 * std::numeric_limits<double>::epsilon() * coordinate;
}
inline double crossing_accuracy(const Vec3& x) {
  return crossing_accuracy(x.cwiseAbs().maxCoeff());
}

inline double exit_distance(const Sphere& sphere, const Vec3& x, const Vec3& d) {
  const Vec3 from = x - sphere.centre;
  const double b = from.dot(d), c = sphere.power(x);
  const double root = std::sqrt(std::max(0.0, b * b - c));
  return std::max(0.0, b > 0 ? -c / (b + root) : root - b);
}
inline double entry_distance(const Sphere& sphere, const Vec3& x, const Vec3& d) {
  const Vec3 from = x - sphere.centre;
  const double b = from.dot(d);
  if (b >= 0) return no_crossing;
  const double square = sphere.radius * sphere.radius;
  const double under = square - (from - b * d).squaredNorm();
  if (under <= 0) return no_crossing;
  return std::max(0.0, sphere.power(x) / (std::sqrt(under) - b));
}

inline double exit_distance(const Plane& plane, const Vec3& x, const Vec3& d) {
  const double speed = plane.outwards.dot(d);
  return speed > 0 ? std::max(0.0, -plane.distance(x) / speed) : no_crossing;
}
inline double entry_distance(const Plane& plane, const Vec3& x, const Vec3& d) {
  return exit_distance(Plane{plane.point, -plane.outwards}, x, d);
}

inline double exit_distance(const Box& box, const Vec3& x, const Vec3& d) {
  double ray_length = no_crossing;
  for (int a = 0; a < 3; ++a) {
    const double face =
        // Compiles without a branch, which would be unpredictable
        d[a] > 0 ? box.high[a] : box.low[a];
    if (d[a] != 0) ray_length = std::min(ray_length, (face - x[a]) / d[a]);
  }
  return std::max(0.0, ray_length);
}
/// Returns the distance at which a line enters the box. Returns infinity if the line misses
/// the box, or if x is inside it by more than rounding.
inline double entry_distance(const Box& box, const Vec3& x, const Vec3& d) {
  double enter = -no_crossing, leave = no_crossing, speed = 0;
  for (int a = 0; a < 3; ++a) {
    if (d[a] == 0) {
      if (x[a] <= box.low[a] || x[a] >= box.high[a]) return no_crossing;
      continue;
    }
    const double low = (box.low[a] - x[a]) / d[a], high = (box.high[a] - x[a]) / d[a];
    const double here = std::min(low, high);
    if (here > enter) {
      enter = here;
      speed = std::abs(d[a]);
    }
    leave = std::min(leave, std::max(low, high));
  }
  return enter < leave && enter * speed >= -crossing_accuracy(x) ? std::max(0.0, enter)
                                                                 : no_crossing;
}

double exit_distance(const Lens& lens, const Vec3& x, const Vec3& d);
double entry_distance(const Lens& lens, const Vec3& x, const Vec3& d);

inline double exit_distance(const LevelSurface& level, const Vec3& x, const Vec3& d) {
  return level.crossing_distance(x, d, -1);
}
inline double entry_distance(const LevelSurface& level, const Vec3& x, const Vec3& d) {
  return level.crossing_distance(x, d, 1);
}

inline double exit_distance(const AsphericLens& lens, const Vec3& x, const Vec3& d) {
  return lens.crossing_distance(x, d, true);
}
inline double entry_distance(const AsphericLens& lens, const Vec3& x, const Vec3& d) {
  return lens.crossing_distance(x, d, false);
}

inline double exit_distance(const TurnedShape& shape, const Vec3& x, const Vec3& d) {
  return shape.exit_distance(x, d);
}
inline double entry_distance(const TurnedShape& shape, const Vec3& x, const Vec3& d) {
  return shape.entry_distance(x, d);
}

inline double exit_distance(const Surface& surface, const Vec3& x, const Vec3& d) {
  return std::visit([&](const auto& s) { return exit_distance(s, x, d); }, surface);
}
inline double entry_distance(const Surface& surface, const Vec3& x, const Vec3& d) {
  return std::visit([&](const auto& s) { return entry_distance(s, x, d); }, surface);
}

/// Whether the inside of a surface is known to be convex.
inline bool is_convex(const Surface& surface) {
  if (const auto* lens = std::get_if<Lens>(&surface)) return lens->is_convex();
  if (const auto* turned = std::get_if<TurnedShape>(&surface)) return turned->is_convex();
  return !std::holds_alternative<LevelSurface>(surface) &&
         !std::holds_alternative<AsphericLens>(surface);
}

}  // namespace flatspeckle::grin
