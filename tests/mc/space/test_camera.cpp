#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "mc/paths/speckle/camera_ends.h"
#include "mc/paths/speckle/camera_resolution.h"
#include "mc/paths/speckle/camera_sum.h"
#include "mc/paths/speckle/speckle_field.h"
#include "tests/mc/space/scenes_in_space.h"

namespace flatspeckle::mc::test_camera {

namespace {

using tests::pi;

Scene box(double g, const FarCamera& camera) {
  SceneSpec spec;
  spec.dimension = 3;
  spec.width = spec.height = 30;
  spec.depth = 10;
  spec.scatterer = "hg";
  spec.g = g;
  spec.optical_depth = 3;
  Scene scene = mc::in_space(make_scene(spec), spec);
  scene.request = field_request({0.1}, camera.views());
  scene.request.camera = camera;
  return scene;
}

double difference(std::span<const Complex> a, std::span<const Complex> b) {
  double off = 0, all = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    off += std::norm(a[i] - b[i]);
    all += std::norm(b[i]);
  }
  return std::sqrt(off / all);
}

}  // namespace

TEST_CASE("camera: sums of ends of paths agree with direct sums to the stated error") {
  const FarCamera forward{{0, 1, 0}, 0.3, 20}, oblique{direction(2.6, 0.7), 0.2, 20};
  for (const FarCamera& camera : {forward, oblique})
    for (const auto& [g, accuracy] : {std::pair{0.5, 1e-2}, {0.5, 1e-4}, {0.8, 1e-2}}) {
      const double tolerance = accuracy;
      CAPTURE(tolerance);
      const Scene scene = box(g, camera);
      const Plan plan = make_plan(scene, ReversedPaths::no);
      const CameraResolution resolution = camera_resolution(scene, plan, 1, tolerance);
      CHECK(resolution.error <= tolerance);
      Plan few = plan;
      few.paths_per_batch = 1000;
      const auto walks = path_walks(scene, few, 2);
      CameraSum fast(*walks, camera, resolution, 2);
      DirectCameraSum direct(*walks, camera);
      std::vector<Complex> found(2 * 400), expected(400);
      each_end(*walks, 0, {}, RandomStream(5, 0, 0),
               [&](const PathEnd& end, std::span<const Complex> c, std::size_t) {
                 const Complex factors[] = {c[0], 0};
                 fast.add(end, factors);
                 direct.add(end, c[0], expected);
               });
      fast.finish(found);
      const double error = difference(std::span(found).first(400), expected);
      CHECK(error < 1.5 * resolution.error);
      CHECK(error > resolution.error / 3);
      CHECK(std::ranges::all_of(std::span(found).last(400),
                                [](Complex value) { return value == 0.0; }));
    }
}

TEST_CASE("camera: rays that leave a box through its sides agree with direct sums") {
  const FarCamera forward{{0, 1, 0}, 0.3, 32}, oblique{direction(0.4, 0.5), 0.2, 32};
  for (const FarCamera& camera : {forward, oblique}) {
    const Scene scene = box(0, camera);
    const auto walks = path_walks(scene, make_plan(scene, ReversedPaths::no), 1);
    CameraSum fast(*walks, camera, {7, 20, 8}, 1);
    DirectCameraSum direct(*walks, camera);
    std::vector<Complex> found(32 * 32), expected(32 * 32);
    // Beside a side, beside two sides, and far from all
    for (const Vec x : {Vec{14, 2, 3}, {-14.5, 1, 14}, {3, 5, -14.9}, {1, 5, 2}}) {
      const Complex one = 1;
      fast.add({x, {0, 1, 0}}, std::span(&one, 1));
      direct.add({x, {0, 1, 0}}, one, expected);
    }
    fast.finish(found);
    CHECK(difference(found, expected) < 3e-5);
  }
}

TEST_CASE("camera: the same paths give the same field as direct sums over its pixels") {
  const FarCamera camera{{0, -1, 0}, 0.2, 8};
  const Scene scene = box(0.5, camera);
  const Plan plan = make_plan(scene, ReversedPaths::yes);
  constexpr std::uint64_t seed = 3, paths = 300;
  constexpr double tolerance = 1e-4;
  const std::size_t size = scene.request.channels.size();
  std::vector<Complex> fast(size), direct(size);
  std::vector<double> intensity(size);
  const auto resolution = camera_resolution(scene, plan, seed, tolerance);
  fields_on_camera(scene, plan, seed, paths, resolution)(0, fast, intensity);
  fields_by_paths(scene, plan, seed, paths)(0, direct, intensity);
  CHECK(difference(fast, direct) < 3 * tolerance);
}

TEST_CASE("camera: mean intensity over the phases agrees with sums over paths") {
  const FarCamera camera{{0, 1, 0}, 0.3, 8};
  const Scene scene = box(0.8, camera);
  const Plan plan = make_plan(scene, ReversedPaths::no);
  constexpr std::uint64_t seed = 3, paths = 2000;
  const std::size_t size = scene.request.channels.size();
  std::vector<Complex> field(size);
  std::vector<double> found(size), expected(size);
  const auto resolution = camera_resolution(scene, plan, seed, 1e-2);
  fields_on_camera(scene, plan, seed, paths, resolution)(0, field, found);
  fields_by_paths(scene, plan, seed, paths)(0, field, expected);
  const auto complex = [](const std::vector<double>& of) {
    return std::vector<Complex>(of.begin(), of.end());
  };
  CHECK(difference(complex(found), complex(expected)) < 0.03);
}

}  // namespace flatspeckle::mc::test_camera
