#pragma once

#include <algorithm>
#include <cmath>
#include <compare>
#include <functional>
#include <limits>

namespace flatspeckle {

/// A point or direction in flatland, the (x, z) plane. x is transverse and z is depth (conventions,
/// C2).
struct Vec2 {
  double x = 0, z = 0;
  auto operator<=>(const Vec2&) const = default;
};

inline Vec2 operator+(Vec2 a, Vec2 b) {
  return {a.x + b.x, a.z + b.z};
}
inline Vec2 operator-(Vec2 a, Vec2 b) {
  return {a.x - b.x, a.z - b.z};
}
inline Vec2 operator-(Vec2 a) {
  return {-a.x, -a.z};
}
inline Vec2 operator*(double s, Vec2 a) {
  return {s * a.x, s * a.z};
}
inline double dot(Vec2 a, Vec2 b) {
  return a.x * b.x + a.z * b.z;
}
inline double length(Vec2 a) {
  return std::hypot(a.x, a.z);
}

/// Returns the unit vector of an angle measured from +z towards +x (C2).
inline Vec2 direction(double angle) {
  return {std::sin(angle), std::cos(angle)};
}
/// Returns the angle of a vector, in (-pi, pi] (C2).
inline double angle_of(Vec2 v) {
  return std::atan2(v.x, v.z);
}

/// An axis-parallel rectangle.
struct Rectangle {
  Vec2 low, high;

  double width() const { return high.x - low.x; }
  double depth() const { return high.z - low.z; }
  /// Returns the shortest distance to another rectangle; 0 if they overlap.
  double distance(const Rectangle& other) const {
    return std::hypot(std::max({0.0, other.low.x - high.x, low.x - other.high.x}),
                      std::max({0.0, other.low.z - high.z, low.z - other.high.z}));
  }
  double distance(Vec2 point) const { return distance(Rectangle{point, point}); }
  Rectangle united(const Rectangle& other) const {
    return {{std::min(low.x, other.low.x), std::min(low.z, other.low.z)},
            {std::max(high.x, other.high.x), std::max(high.z, other.high.z)}};
  }
};

/// Returns the smallest rectangle that contains the positions of all `things`. place: function or
/// member that gives the position of a thing. If there are no things, low is +infinity and high is
/// -infinity.
template <typename Things, typename Place = std::identity>
Rectangle bounds_of(const Things& things, const Place& place = {}) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Rectangle box{{infinity, infinity}, {-infinity, -infinity}};
  for (const auto& thing : things) {
    const Vec2 x = std::invoke(place, thing);
    box = box.united({x, x});
  }
  return box;
}

/// Region that contains the scatterers: the box |x| <= width/2, 0 <= z <= depth, or the slab 0 <= z
/// <= depth, which is infinite in x.
struct Domain {
  enum class Kind { box, slab };
  Kind kind = Kind::box;
  double width = 0, depth = 0;

  double area() const { return width * depth; }

  bool contains(Vec2 r) const {
    return r.z >= 0 && r.z <= depth && (kind == Kind::slab || std::abs(r.x) <= width / 2);
  }

  /// Returns the distance from a point r inside the domain to its edge along the unit vector w. It
  /// is infinite in a slab if w is parallel to the faces.
  double distance_to_edge(Vec2 r, Vec2 w) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double along_z = w.z > 0 ? (depth - r.z) / w.z : w.z < 0 ? -r.z / w.z : infinity;
    if (kind == Kind::slab) return std::max(0.0, along_z);
    const double along_x = w.x > 0   ? (width / 2 - r.x) / w.x
                           : w.x < 0 ? (-width / 2 - r.x) / w.x
                                     : infinity;
    return std::max(0.0, std::min(along_x, along_z));
  }
};

}  // namespace flatspeckle
