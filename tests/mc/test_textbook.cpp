// The textbook estimator, an oracle, against closed forms and against ours.
#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/slab_theory.h"
#include "bench/oracles/textbook.h"
#include "mc/slab/adding/space.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_textbook {

namespace {

using tests::pi;

constexpr double k = 2 * pi;

Estimate textbook(const Scene& scene, bool reversed, std::uint64_t paths, std::uint64_t seed) {
  const FieldJob job = oracles::textbook_job(scene, reversed, 200, seed);
  return jackknife(tests::summed(job.batches, tests::shortened(paths)), job.covariance);
}

void check_same(const Scene& scene, bool reversed, std::uint64_t paths) {
  const Estimate expected = textbook(scene, reversed, paths, 51);
  const auto choice = reversed ? ReversedPaths::yes : ReversedPaths::no;
  const Estimate found = tests::run(scene, choice, paths, 52).entries();
  for (std::size_t e = 0; e < found.value.size(); ++e) {
    CAPTURE(e);
    CHECK_WITHIN_4_SIGMA(found.value[e], std::hypot(found.error[e], expected.error[e]),
                         expected.value[e], 1e-4 * std::abs(expected.value[e]));
  }
  CHECK(relative_error(expected) < 0.03);  // so that the test is significant
  CHECK(relative_error(found) < 0.03);
}

SceneSpec box(std::int64_t count) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.count = count;
  spec.view_angles = {0.1, 0.8, pi - 0.3, pi};
  spec.covariance = "memory_effect";
  spec.tilts = {0, 0.04, 0.16};
  return spec;
}

SceneSpec cylinders() {
  SceneSpec spec = box(67);
  spec.scatterer = "tm";
  spec.radius = 1 / k;
  spec.index = "1.5";
  return spec;
}

/// A box in space, seen out of the plane of incidence under tilts that are also out of it.
Scene space_box(std::int64_t count, const std::string& scatterer, double albedo) {
  SceneSpec spec = box(count);
  spec.dimension = 3;
  spec.width = spec.height = 10;
  spec.light_angles = {0.4};
  spec.light_azimuths = {-0.5};
  spec.view_azimuths = {0, 1, 2, 0};
  spec.tilt_azimuth = 0.7;
  spec.scatterer = scatterer;
  if (scatterer == "point")
    spec.albedo = albedo;
  else {
    spec.radius = 1 / k;
    spec.index = "2";
  }
  return in_space(make_scene(spec), spec);
}

using Channel = oracles::IsotropicSlab::Channel;

void check_theory(double albedo, bool reversed, std::uint64_t seed) {
  const double depth = 20, optical_depth = 5, light = 0.2;
  const auto request = memory_effect_request(
      k, light, {0.1, light + pi, light + pi + 0.01, light + pi - 0.6}, {0.004, -0.02});
  const oracles::IsotropicSlab theory(k, depth, optical_depth / depth, albedo);
  const Scene scene = tests::hg_slab(depth, {depth / optical_depth, 0, albedo}, request);
  const Estimate found = textbook(scene, reversed, 60000, seed);
  const auto channel = [&](std::size_t number) {
    const auto c = request.channels[number];
    return Channel{request.lights[c.light].angle, request.views[c.view].angle};
  };
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    CAPTURE(e);
    const Channel a = channel(request.entries[e].a), b = channel(request.entries[e].b);
    const Complex expected = reversed ? theory.with_reversed(a, b) : theory.without_reversed(a, b);
    CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected, 3e-4 * std::abs(expected));
  }
  CHECK(relative_error(found) < 0.03);
}

}  // namespace

TEST_CASE("textbook estimator: agrees with the integral equation of an isotropic slab") {
  check_theory(1, false, 61);
  check_theory(0.8, false, 62);
}

TEST_CASE("textbook estimator: reversed paths agree with the crossed integral equation") {
  check_theory(1, true, 63);
  check_theory(0.8, true, 64);
}

TEST_CASE("box of points: estimates agree with the textbook estimator") {
  const Scene lossless = make_scene(box(31));
  check_same(lossless, false, 40000);
  check_same(lossless, true, 40000);
  SceneSpec absorbing = box(39);
  absorbing.albedo = 0.8;
  check_same(make_scene(absorbing), true, 40000);
}

TEST_CASE("box of cylinders: estimates agree with the textbook estimator") {
  check_same(make_scene(cylinders()), false, 40000);
  check_same(make_scene(cylinders()), true, 40000);
}

TEST_CASE("boxes in space: estimates agree with the textbook estimator") {
  check_same(space_box(300, "point", 1), true, 20000);
  check_same(space_box(375, "point", 0.8), false, 20000);
  check_same(space_box(313, "penetrable", 1), true, 20000);
}

TEST_CASE("Henyey-Greenstein slabs: estimates agree with the textbook estimator") {
  const auto forward = memory_effect_request(k, 0, {0, 0.5}, {0, 2e-4, 6e-4});
  const auto backward = memory_effect_request(k, 0, {pi, pi - 0.3}, {0, 2e-4, 6e-4});
  for (const double g : {0.0, 0.5, 0.9}) {
    if (!tests::is_night && g == 0) continue;
    CAPTURE(g);
    check_same(tests::hg_slab(1000, {100, g, 1}, forward), false, 40000);
    check_same(tests::hg_slab(1000, {100, g, 0.95}, backward), true, 40000);
  }
}

}  // namespace flatspeckle::mc::test_textbook
