// Covariance of fields that are drawn on a camera.
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "mc/paths/speckle/camera_resolution.h"
#include "mc/paths/speckle/speckle_field.h"
#include "tests/mc/space/scenes_in_space.h"

namespace flatspeckle::mc::test_camera_covariance {

namespace {

constexpr std::size_t pixels = 64;
constexpr double aperture = 0.1, pixel = 2 * aperture / pixels;
constexpr int shift = 6;  ///< pixels by which the second light moves the pattern

struct Pixel {
  std::size_t row, column;
};
/// Some neighbours, pixels from which the pattern moves to others, and some far ones.
constexpr Pixel chosen[] = {{20, 20}, {20, 24}, {24, 20},         {20, 20 + shift},
                            {31, 31}, {32, 32}, {31, 31 + shift}, {50, 10}};

Scene box(const FarCamera& camera) {
  SceneSpec spec;
  spec.dimension = 3;
  spec.width = spec.height = 30;
  spec.depth = 10;
  spec.scatterer = "hg";
  spec.g = 0.5;
  spec.optical_depth = 2;
  Scene scene = mc::in_space(make_scene(spec), spec);
  scene.request =
      field_request(Lights{plane_wave(0), plane_wave(std::asin(shift * pixel))}, camera.views());
  scene.request.camera = camera;
  return scene;
}

/// Returns the same scene, in which all covariances of the chosen pixels are requested.
Scene with_chosen_pixels(Scene scene) {
  std::vector<View> views;
  for (const auto [row, column] : chosen)
    views.push_back(scene.request.views[row * pixels + column]);
  scene.request = full_request(scene.request.lights, views);
  return scene;
}

/// Checks the mean products of `fields` fields, each drawn by `paths` paths, entry by entry and by
/// the sum of squared deviations in standard errors.
void check_camera(Vec axis, int fields, std::uint64_t paths, std::uint64_t covariance_paths) {
  const FarCamera camera{axis, aperture, pixels};
  const Scene scene = box(camera), few = with_chosen_pixels(scene);
  const Plan plan = make_plan(scene, ReversedPaths::automatic);
  CHECK(plan.reversed == (axis.z < 0));
  const auto expected = tests::run(few, ReversedPaths::automatic, covariance_paths, 7).entries();

  const auto draw =
      fields_on_camera(scene, plan, 8, paths, camera_resolution(scene, plan, 1, 1e-3));
  const std::size_t size = few.request.entries.size();
  std::vector<Complex> field(scene.request.channels.size()), mean(size);
  std::vector<double> intensity(field.size()), square(size);
  const auto at = [&](std::size_t channel) {
    const auto [light, view] = few.request.channels[channel];
    return field[light * pixels * pixels + chosen[view].row * pixels + chosen[view].column];
  };
  for (int number = 0; number < fields; ++number) {
    draw(static_cast<std::uint64_t>(number), field, intensity);
    for (std::size_t e = 0; e < size; ++e) {
      const auto [a, b] = few.request.entries[e];
      const Complex product = at(a) * std::conj(at(b));
      mean[e] += product / static_cast<double>(fields);
      square[e] += std::norm(product) / fields;
    }
  }
  double chi_square = 0;
  for (std::size_t e = 0; e < size; ++e) {
    CAPTURE(e);
    const double error = std::sqrt((square[e] - std::norm(mean[e])) / (fields - 1));
    const double combined = std::hypot(error, expected.error[e]);
    const double off = std::abs(mean[e] - expected.value[e]) / combined;
    CHECK(off < 4.5);
    CHECK(expected.error[e] < error);
    chi_square += off * off;
  }
  // The mean of |z|^2 is 1, and its variance, for independent complex entries, is 1. Entries of
  // neighbouring pixels are correlated, so that the allowed deviation is doubled.
  const double count = static_cast<double>(size);
  MESSAGE("mean squared deviation in standard errors ", chi_square / count);
  CHECK(std::abs(chi_square / count - 1) < 2 * 4 / std::sqrt(count));
}

}  // namespace

TEST_CASE("camera: covariance of 400 fields agrees with the covariance of their pixels") {
  check_camera({0, 1, 0}, 400, 30, 10000);
  check_camera({0, -1, 0}, 400, 30, 10000);
}

TEST_CASE("nightly: camera: covariance of 4000 fields agrees with that of their pixels") {
  check_camera({0, 1, 0}, 4000, 100, 1000000);
  check_camera({0, -1, 0}, 4000, 100, 1000000);
}

}  // namespace flatspeckle::mc::test_camera_covariance
