#pragma once

#include "bench/scenes/furnaces.h"
#include "tests/grin/render_tests.h"

namespace flatspeckle::grin::tests {

using namespace bench;

inline constexpr RenderMethod unbiased_methods[] = {RenderMethod::path, RenderMethod::light,
                                                    RenderMethod::bidirectional};

/// Checks that the radiance equals that of the environment, L/n^2 = 1, so that a detector measures
/// pi times the mean of n^2. Returns the relative standard error.
inline double check_furnace_face(RenderScene scene, RenderMethod method, double samples) {
  const double expected = std::numbers::pi * mean_square_index(scene);
  const Rendered result = rendered(scene, method, samples);
  CAPTURE(name(method));
  CHECK(result.counts.lost_values == 0);
  CHECK(result.counts.lost_flights == 0);
  CHECK(result.value() > 0);
  CHECK(std::abs(result.value() - expected) < 4 * result.error() + 1e-9 * expected);
  return result.error() / expected;
}

/// Checks that a camera in the field measures 1 in each pixel, within 4 standard errors plus
/// `negligible`. Returns the largest standard error.
inline double check_furnace_camera(RenderScene scene, RenderMethod method, double samples,
                                   const Vec3& at = {0.2, -0.1, -0.8}, double negligible = 1e-9) {
  scene.sensors = {Camera{at, Vec3::UnitZ(), Vec3::UnitY(), 1.2, {2, 1}}};
  const Rendered result = rendered(scene, method, samples);
  CAPTURE(name(method));
  double worst = 0;
  for (int pixel = 0; pixel < 2; ++pixel) {
    CAPTURE(pixel);
    CHECK(std::abs(result.value(pixel) - 1) < 4 * result.error(pixel) + negligible);
    worst = std::max(worst, result.error(pixel));
  }
  return worst;
}

}  // namespace flatspeckle::grin::tests
