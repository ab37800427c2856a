#pragma once

#include <algorithm>
#include <cmath>
#include <compare>
#include <functional>
#include <limits>

namespace flatspeckle {

/// A point or direction. x and y are transverse and z is depth (conventions, C2 and C55). In the
/// plane y is 0, so that one code computes media in the plane and in space.
struct Vec {
  double x = 0, z = 0, y = 0;
  auto operator<=>(const Vec&) const = default;
};

inline Vec operator+(Vec a, Vec b) {
  return {a.x + b.x, a.z + b.z, a.y + b.y};
}
inline Vec operator-(Vec a, Vec b) {
  return {a.x - b.x, a.z - b.z, a.y - b.y};
}
inline Vec operator-(Vec a) {
  return {-a.x, -a.z, -a.y};
}
inline Vec operator*(double s, Vec a) {
  return {s * a.x, s * a.z, s * a.y};
}
inline double dot(Vec a, Vec b) {
  return a.x * b.x + a.z * b.z + a.y * b.y;
}
inline Vec cross(Vec a, Vec b) {
  return {a.y * b.z - a.z * b.y, a.x * b.y - a.y * b.x, a.z * b.x - a.x * b.z};
}
inline double length(Vec a) {
  return a.y == 0 ? std::hypot(a.x, a.z) : std::hypot(a.x, a.y, a.z);
}

/// Returns the unit vector of an angle measured from +z towards +x (C2) or, with an azimuth,
/// towards the direction of x that is rotated towards y by the azimuth (C55).
inline Vec direction(double angle, double azimuth = 0) {
  if (azimuth == 0) return {std::sin(angle), std::cos(angle)};
  return {std::sin(angle) * std::cos(azimuth), std::cos(angle),
          std::sin(angle) * std::sin(azimuth)};
}
/// Returns the angle of a vector in the plane, in (-pi, pi] (C2).
inline double angle_of(Vec v) {
  return std::atan2(v.x, v.z);
}

/// An axis-parallel rectangle in the plane.
struct Rectangle {
  Vec low, high;

  double width() const { return high.x - low.x; }
  double depth() const { return high.z - low.z; }
  /// Returns the shortest distance to another rectangle; 0 if they overlap.
  double distance(const Rectangle& other) const {
    return std::hypot(std::max({0.0, other.low.x - high.x, low.x - other.high.x}),
                      std::max({0.0, other.low.z - high.z, low.z - other.high.z}));
  }
  double distance(Vec point) const { return distance(Rectangle{point, point}); }
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
    const Vec x = std::invoke(place, thing);
    box = box.united({x, x});
  }
  return box;
}

/// Region that contains the scatterers: the box |x| <= width/2, 0 <= z <= depth, in space also |y|
/// <= height/2; or the slab 0 <= z <= depth, which is infinite in x and y.
struct Domain {
  enum class Kind { box, slab };
  Kind kind = Kind::box;
  double width = 0, depth = 0;
  double height = 0;  ///< 0 in the plane

  /// Returns the area or, in space, the volume of a box.
  double content() const { return width * depth * (height > 0 ? height : 1); }

  bool contains(Vec r) const {
    return r.z >= 0 && r.z <= depth &&
           (kind == Kind::slab || (std::abs(r.x) <= width / 2 && std::abs(r.y) <= height / 2));
  }

  /// Returns the distance from a point r inside a box to its side along the unit vector w.
  double distance_to_side(Vec r, Vec w) const {
    const double along_x = to_plane(r.x, w.x, width / 2);
    return height > 0 ? std::min(along_x, to_plane(r.y, w.y, height / 2)) : along_x;
  }

  /// Returns the distance from a point r inside the domain to its edge along the unit vector w. It
  /// is infinite in a slab if w is parallel to the faces.
  double distance_to_edge(Vec r, Vec w) const {
    const double along_z = w.z > 0 ? (depth - r.z) / w.z : w.z < 0 ? -r.z / w.z : infinity;
    if (kind == Kind::slab) return std::max(0.0, along_z);
    return std::max(0.0, std::min(distance_to_side(r, w), along_z));
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  static double to_plane(double r, double w, double half) {
    return w > 0 ? (half - r) / w : w < 0 ? (-half - r) / w : infinity;
  }
};

}  // namespace flatspeckle
