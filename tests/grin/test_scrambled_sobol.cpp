#include <set>
#include <vector>

#include <doctest/doctest.h>

#include "grin/render/transport/scrambled_sobol.h"
#include "tests/grin/furnace.h"
#include "tests/grin/render_tests.h"

namespace flatspeckle::grin::tests::test_scrambled_sobol {

TEST_CASE("scrambled Sobol points: the first 64 are stratified in the pixel and along each axis") {
  for (std::uint64_t pixel = 0; pixel < 200; ++pixel) {
    const ScrambledSobol points(pixel % 3, pixel);
    std::set<int> cells;
    std::array<std::set<int>, 4> intervals;
    for (std::uint64_t number = 0; number < 64; ++number) {
      const auto u = points.point(number);
      cells.insert(static_cast<int>(u[0] * 8) * 8 + static_cast<int>(u[1] * 8));
      for (std::size_t axis = 0; axis < 4; ++axis)
        intervals[axis].insert(static_cast<int>(u[axis] * 64));
    }
    CHECK(cells.size() == 64);
    for (const auto& of_axis : intervals) CHECK(of_axis.size() == 64);
  }
}

TEST_CASE(
    "scrambled Sobol points: one point of many sequences is uniform in pairs of coordinates") {
  constexpr std::size_t side = 16;
  const int pixels = 50'000;
  for (const auto& [a, b] : {std::pair{0, 1}, {0, 3}, {1, 2}, {2, 3}}) {
    std::vector<double> counts(side * side);
    for (int pixel = 0; pixel < pixels; ++pixel) {
      const auto u = ScrambledSobol(7, static_cast<std::uint64_t>(pixel)).point(5);
      const auto at = [&](int axis) { return static_cast<std::size_t>(u[axis] * side); };
      ++counts[at(a) * side + at(b)];
    }
    const double expected = pixels / static_cast<double>(side * side);
    double square = 0;
    for (const double count : counts) square += (count - expected) * (count - expected) / expected;
    const double freedom = side * side - 1;
    CHECK(std::abs(square - freedom) < 4 * std::sqrt(2 * freedom));
  }
}

namespace {

/// Returns a cube under an even environment with a pinhole camera.
RenderScene furnace() {
  return {.field = Homogeneous{},
          .step = 1,
          .max_length = 1e3,
          .stage = {.boundary = Box{{-4, -4, -4}, {4, 4, 4}}},
          .lights = {environment()},
          .sensors = {Camera{{0, 3.9, 0}, -Vec3::UnitY(), Vec3::UnitZ(), 0.7, {16, 12}}}};
}

}  // namespace

TEST_CASE("pictures: an empty stage under an even environment has no noise") {
  for (const bool has_ball : {false, true}) {
    CAPTURE(has_ball);
    RenderScene scene = furnace();
    if (has_ball) scene.stage.bodies.push_back({Sphere{{0, 0, 0}, 1}, {.mu_s = 2}, 0});
    for (const int threads : {1, 3}) {
      const RenderJob job = render_job(scene, {}, 5);
      const Estimate picture = rendered_picture(job, run_render(job, 5000, threads).sums).steady;
      for (std::size_t i = 0; i < picture.value.size(); ++i) {
        CHECK(std::abs(picture.value[i] - 1.0) < 1e-12);
        CHECK(picture.error[i] < 1e-12);
      }
    }
  }
}

TEST_CASE("pictures: each batch has equally many paths in each pixel") {
  RenderScene scene = furnace();
  scene.sensors = {Camera{{0, 3.9, 0}, -Vec3::UnitY(), Vec3::UnitZ(), 0.7, {37, 11}}};
  const RenderJob job = render_job(scene, {RenderMethod::path}, 5);
  CHECK(static_cast<int>(job.batches.samples_per_batch) % (37 * 11) == 0);
}

}  // namespace flatspeckle::grin::tests::test_scrambled_sobol
