#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "grin/rays/surfaces/lens.h"
#include "grin/rays/surfaces/signed_distance.h"

namespace flatspeckle::grin {

// How far a straight ray goes from x along the unit vector d until it leaves a surface (way_out; x
// is inside) or enters it (way_in; x is outside; infinity where it does not). A point on the
// surface to rounding is on the side that the caller says: what it just passed is not met again.

inline constexpr double no_way = std::numeric_limits<double>::infinity();

/// To which a line of such coordinates is found to meet a surface.
inline double crossing_accuracy(double coordinate) {
  return 32 * std::numeric_limits<double>::epsilon() * coordinate;
}
inline double crossing_accuracy(const Vec3& x) {
  return crossing_accuracy(x.cwiseAbs().maxCoeff());
}

inline double way_out(const Sphere& sphere, const Vec3& x, const Vec3& d) {
  const Vec3 from = x - sphere.centre;
  const double b = from.dot(d), c = sphere.power(x);
  const double root = std::sqrt(std::max(0.0, b * b - c));
  return std::max(0.0, b > 0 ? -c / (b + root) : root - b);
}
inline double way_in(const Sphere& sphere, const Vec3& x, const Vec3& d) {
  const Vec3 from = x - sphere.centre;
  const double b = from.dot(d);
  if (b >= 0) return no_way;
  const double square = sphere.radius * sphere.radius;
  const double under = square - (from - b * d).squaredNorm();
  if (under <= 0) return no_way;
  return std::max(0.0, sphere.power(x) / (std::sqrt(under) - b));
}

inline double way_out(const Plane& plane, const Vec3& x, const Vec3& d) {
  const double speed = plane.outwards.dot(d);
  return speed > 0 ? std::max(0.0, -plane.distance(x) / speed) : no_way;
}
inline double way_in(const Plane& plane, const Vec3& x, const Vec3& d) {
  return way_out(Plane{plane.point, -plane.outwards}, x, d);
}

inline double way_out(const Box& box, const Vec3& x, const Vec3& d) {
  double way = no_way;
  for (int a = 0; a < 3; ++a) {
    const double face = d[a] > 0 ? box.high[a] : box.low[a];  // no branch: which one is chance
    if (d[a] != 0) way = std::min(way, (face - x[a]) / d[a]);
  }
  return std::max(0.0, way);
}
/// What is within already, to more than rounding, is on its way out.
inline double way_in(const Box& box, const Vec3& x, const Vec3& d) {
  double enter = -no_way, leave = no_way, speed = 0;
  for (int a = 0; a < 3; ++a) {
    if (d[a] == 0) {
      if (x[a] <= box.low[a] || x[a] >= box.high[a]) return no_way;
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
  return enter < leave && enter * speed >= -crossing_accuracy(x) ? std::max(0.0, enter) : no_way;
}

double way_out(const Lens& lens, const Vec3& x, const Vec3& d);
double way_in(const Lens& lens, const Vec3& x, const Vec3& d);

inline double way_out(const LevelSurface& level, const Vec3& x, const Vec3& d) {
  return level.way(x, d, -1);
}
inline double way_in(const LevelSurface& level, const Vec3& x, const Vec3& d) {
  return level.way(x, d, 1);
}

inline double way_out(const Surface& surface, const Vec3& x, const Vec3& d) {
  return std::visit([&](const auto& s) { return way_out(s, x, d); }, surface);
}
inline double way_in(const Surface& surface, const Vec3& x, const Vec3& d) {
  return std::visit([&](const auto& s) { return way_in(s, x, d); }, surface);
}

/// The inside: a straight line between two points of it stays in it.
inline bool is_convex(const Surface& surface) {
  if (const auto* lens = std::get_if<Lens>(&surface)) return lens->is_convex();
  return !std::holds_alternative<LevelSurface>(surface);
}

}  // namespace flatspeckle::grin
