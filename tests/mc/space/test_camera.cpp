#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
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

TEST_CASE("camera: sums of ends agree with direct sums to the stated error") {
  const FarCamera forward{{0, 1, 0}, 0.3, 20}, oblique{direction(2.6, 0.7), 0.2, 20};
  for (const FarCamera& camera : {forward, oblique})
    for (const auto& [g, accuracy] : {std::pair{0.5, 1e-2}, {0.5, 1e-4}, {0.8, 1e-2}}) {
      const double tolerance = accuracy;
      CAPTURE(tolerance);
      const Scene scene = box(g, camera);
      const auto walks = path_walks(scene, make_plan(scene, ReversedPaths::no), 1);
      const CameraResolution resolution = camera_resolution(*walks, tolerance);
      CHECK(resolution.error <= tolerance);
      CameraSum fast(*walks, camera, resolution, 2);
      DirectCameraSum direct(*walks, camera);
      std::vector<Complex> found(2 * 400), expected(400);
      RandomStream random(5, 0, 0);
      for (int end = 0; end < 50; ++end) {
        const Vec x{30 * (random.uniform() - 0.5), 10 * random.uniform(),
                    30 * (random.uniform() - 0.5)};
        const Vec w = direction(std::acos(2 * random.uniform() - 1), 2 * pi * random.uniform());
        const Complex c[] = {std::polar(1.0, 9 * random.uniform()), 0};
        fast.add(x, w, c);
        direct.add(x, w, c[0], expected);
      }
      fast.finish(found);
      const auto first = std::span(found).first(400);
      CHECK(difference(first, expected) < 2 * tolerance);
      CHECK(std::ranges::all_of(std::span(found).last(400),
                                [](Complex value) { return value == 0.0; }));
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
  const auto resolution = camera_resolution(*path_walks(scene, plan, seed), tolerance);
  fields_on_camera(scene, plan, seed, paths, resolution)(0, fast, intensity);
  fields_by_paths(scene, plan, seed, paths)(0, direct, intensity);
  CHECK(difference(fast, direct) < 3 * tolerance);
}

}  // namespace flatspeckle::mc::test_camera
