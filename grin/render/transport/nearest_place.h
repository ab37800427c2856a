#pragma once

#include <variant>

#include "grin/render/sensors/sensor.h"

namespace flatspeckle::grin {

/// Where light from a point in the stage gets to a sensor soonest, if straight.
class NearestPlace {
 public:
  /// Of a boundary that is a box or a sphere.
  NearestPlace(const Sensor& sensor, const Surface& boundary);

  Vec3 operator()(const Vec3& x) const {
    return std::visit([&](const auto& place) { return place.from(x); }, place_);
  }

 private:
  struct Point {
    Vec3 x;
    Vec3 from(const Vec3&) const { return x; }
  };
  /// Of a tangent plane, or the sphere's in front of it.
  struct Rectangle {
    Vec3 centre, normal, right, up;
    double half_width, half_height, radius;  ///< radius: of the sphere, 0 of a box
    Vec3 from(const Vec3& x) const;
  };
  /// Of the faces that light of this direction leaves through.
  struct Faces {
    Box box;
    Vec3 forward;
    Vec3 from(const Vec3& x) const;
  };
  struct HalfSphere {
    Sphere sphere;
    Vec3 forward;
    Vec3 from(const Vec3& x) const;
  };
  using Place = std::variant<Point, Rectangle, Faces, HalfSphere>;

  static Place place(const Camera& camera, const Surface& boundary);
  static Place place(const AreaDetector& detector, const Surface& boundary);
  static Place place(const RadialDetector& detector, const Surface& boundary);
  static Place place(const DirectionalDetector& detector, const Surface& boundary);
  static Place place(const PolarDetector& detector, const Surface& boundary);
  static Place in_front(const Vec3& forward, const Surface& boundary);

  Place place_;
};

}  // namespace flatspeckle::grin
