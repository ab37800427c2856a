#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include <doctest/doctest.h>

#include "tests/grin/render_tests.h"

namespace flatspeckle::grin::tests {

// Slabs of matched index under a beam.

enum class Face { reflected, transmitted };

/// Returns a box so wide that hardly any light reaches its sides. The detector covers one face; the
/// beam has power 1.
inline RenderScene slab(const ScatteringMedium& medium, double thickness, double half_width,
                        Face face) {
  const Vec3 low(-half_width, -half_width, 0), high(half_width, half_width, thickness);
  const double z = face == Face::reflected ? 0 : thickness;
  RenderScene scene{};
  scene.step = 1;
  scene.max_length = 1e9;
  scene.stage.boundary = Box{low, high};
  scene.stage.medium = medium;
  scene.lights = {BeamLight{{0, 0, 0}, {0, 0, 1}, thickness / 100}};
  scene.sensors = {
      AreaDetector{{0, 0, z}, {0, 1, 0}, 2 * half_width, 2 * half_width, {}, std::numbers::pi / 2}};
  return scene;
}

inline ScatteringMedium isotropic(double albedo) {
  ScatteringMedium medium;
  medium.mu_s = albedo;
  medium.mu_a = 1 - albedo;
  return medium;
}

/// Returns the slab of Prahl, Keijzer, Jacques and Welch 1989, table 1; lengths in cm.
inline RenderScene van_de_hulst(Face face) {
  ScatteringMedium medium;
  medium.mu_s = 90;
  medium.mu_a = 10;
  medium.phase = {HgPhase{0.75}};
  return slab(medium, 0.02, 0.5, face);
}

inline void check_share(const RenderScene& scene, RenderMethod method, const Rendered& picture,
                        double expected, double largest_error) {
  const AreaDetector& detector = std::get<AreaDetector>(scene.sensors[0]);
  const double area = detector.width * detector.height;
  const double value = area * picture.value(), error = area * picture.error();
  const std::string how = name(method);
  CAPTURE(how);
  CAPTURE(value);
  CAPTURE(error);
  CAPTURE(expected);
  CHECK(error < largest_error);
  CHECK(std::abs(value - expected) < 4 * error);
}
inline void check_share(const RenderScene& scene, RenderMethod method, double samples,
                        double expected, double largest_error) {
  check_share(scene, method, rendered(scene, method, samples), expected, largest_error);
}
/// Checks the fraction of power by a run that stops at the given error. With a fixed number of
/// samples, the error itself would scatter by about 5 %.
inline void check_share_to(const RenderScene& scene, RenderMethod method, double expected,
                           double largest_error) {
  StopRule stop;
  stop.target_error = largest_error / expected;
  check_share(scene, method, rendered(scene, {method}, stop), expected, 1.001 * largest_error);
}

}  // namespace flatspeckle::grin::tests
