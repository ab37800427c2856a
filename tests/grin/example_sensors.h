#pragma once

#include <numbers>

#include "grin/render/sensors/sensor.h"
#include "tests/grin/path_endpoints.h"

namespace flatspeckle::grin {

// Example sensors in test_box and test_sphere.

inline Camera pinhole() {
  return {Vec3(0.4, -0.6, 1.4), Vec3(1, 0.5, -0.3), Vec3(0, 0.2, 1), 1.2, {5, 3}};
}
/// Returns a tilted camera whose lens is on the upper face.
inline Camera lens_on_box() {
  Camera camera{Vec3(0.6, -0.4, 3), Vec3(0.1, 0.05, -1), Vec3(0.3, 1, 0), 1.1, {4, 3}};
  camera.lens_radius = 0.5;
  camera.focus_distance = 2;
  return camera;
}
inline Camera lens_on_sphere() {
  const Vec3 outward = Vec3(-2, 1, 2) / 3;
  Camera camera{test_sphere.centre + test_sphere.radius * outward,
                -outward + Vec3(0.2, 0, 0),
                Vec3(0, 0, 1),
                1.4,
                {3, 4}};
  camera.lens_radius = 0.9;
  camera.focus_distance = 2.5;
  return camera;
}
inline AreaDetector area_on_box(double acceptance = std::numbers::pi / 2) {
  return {Vec3(0.6, -0.4, 3), Vec3(0.3, 1, 0), 1.6, 1.2, {4, 3}, acceptance};
}
inline AreaDetector area_on_sphere(double acceptance = std::numbers::pi / 2) {
  return {test_sphere.centre + test_sphere.radius * Vec3(-2, 1, 2) / 3,
          Vec3(0, 0, 1),
          1.6,
          1.2,
          {4, 3},
          acceptance};
}
inline RadialDetector radial_on_box(double acceptance = std::numbers::pi / 2) {
  return {Vec3(0.6, -0.4, 3), 1.2, 5, acceptance};
}
inline RadialDetector radial_on_sphere(double acceptance = std::numbers::pi / 2) {
  return {area_on_sphere().centre, 1.6, 4, acceptance};
}
inline PolarDetector polar(double half_angle) {
  return {Vec3(0.2, -0.4, 1), half_angle, 6};
}
inline DirectionalDetector directional(double half_angle) {
  return {Vec3(0.2, -0.4, 1), Vec3(0, 1, 0.3), half_angle, {4, 5}};
}

}  // namespace flatspeckle::grin
