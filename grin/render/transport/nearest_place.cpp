#include "grin/render/transport/nearest_place.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "grin/media/geometry/frame.h"

namespace flatspeckle::grin {

NearestPlace::NearestPlace(const Sensor& sensor, const Surface& boundary)
    : place_(std::visit([&](const auto& kind) { return place(kind, boundary); }, sensor)) {}

NearestPlace::Place NearestPlace::place(const Camera& camera, const Surface&) {
  return Point{camera.x};
}

NearestPlace::Place NearestPlace::place(const AreaDetector& detector, const Surface& boundary) {
  const Vec3 normal = grin::normal(boundary, detector.centre);
  const Vec3 right = normal.cross(detector.up).normalized();
  const auto* sphere = std::get_if<Sphere>(&boundary);
  return Rectangle{detector.centre,
                   normal,
                   right,
                   right.cross(normal),
                   detector.width / 2,
                   detector.height / 2,
                   sphere ? sphere->radius : 0};
}

/// As of the square around it.
NearestPlace::Place NearestPlace::place(const RadialDetector& detector, const Surface& boundary) {
  const Vec3 normal = grin::normal(boundary, detector.centre);
  const double side = 2 * detector.radius;
  return place(AreaDetector{detector.centre, frame_across(normal).col(0), side, side, {}, 0},
               boundary);
}

NearestPlace::Place NearestPlace::place(const DirectionalDetector& detector,
                                        const Surface& boundary) {
  return in_front(detector.forward, boundary);
}

NearestPlace::Place NearestPlace::place(const PolarDetector& detector, const Surface& boundary) {
  return in_front(detector.axis, boundary);
}

NearestPlace::Place NearestPlace::in_front(const Vec3& forward, const Surface& boundary) {
  if (const auto* box = std::get_if<Box>(&boundary)) return Faces{*box, forward};
  return HalfSphere{std::get<Sphere>(boundary), forward};
}

Vec3 NearestPlace::Rectangle::from(const Vec3& x) const {
  const Vec3 away = x - centre;
  const double u = std::clamp(away.dot(right), -half_width, half_width);
  const double v = std::clamp(away.dot(up), -half_height, half_height);
  const Vec3 flat = centre + u * right + v * up;
  if (radius == 0) return flat;
  const double height = std::max(0.0, radius * radius - u * u - v * v);
  return flat - (radius - std::sqrt(height)) * normal;
}

Vec3 NearestPlace::Faces::from(const Vec3& x) const {
  double least = std::numeric_limits<double>::infinity();
  int nearest = 0;
  const auto face = [&](int axis) { return forward[axis] > 0 ? box.high[axis] : box.low[axis]; };
  for (int axis = 0; axis < 3; ++axis) {
    const double way = std::abs(face(axis) - x[axis]);
    if (forward[axis] == 0 || way >= least) continue;
    least = way;
    nearest = axis;
  }
  Vec3 found = x;
  found[nearest] = face(nearest);
  return found;
}

Vec3 NearestPlace::HalfSphere::from(const Vec3& x) const {
  Vec3 away = x - sphere.centre;
  away -= std::min(0.0, away.dot(forward)) * forward;
  const double length = away.norm();
  return sphere.centre + (length > 0 ? sphere.radius / length * away : sphere.radius * forward);
}

}  // namespace flatspeckle::grin
