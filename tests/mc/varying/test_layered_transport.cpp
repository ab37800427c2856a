// Layers by transport: divided slabs against undivided ones, different layers against Monte Carlo.
#include <cmath>
#include <memory>

#include "core/error.h"
#include "flatland/media/layers.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/estimators/flux_walk.h"
#include "mc/slab/slab_covariance.h"
#include "mc/slab/slab_flux.h"
#include "mc/slab/slab_jobs.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_layered_transport {

namespace {

using tests::is_night;
using tests::Layer;
using tests::layered;
using tests::pi;

/// Relative error of transport, below the errors of the Monte Carlo runs.
const double precision = is_night ? 1e-4 : 1e-3;

/// Requests intensities and a tilt in transmission, reflection and near backscattering.
CovarianceRequest some_pairs() {
  const double light = 0.3, q = 0.004;
  const auto tilted = [&](double angle) {
    const double turned = std::asin(std::sin(angle) + q);
    return std::cos(angle) > 0 ? turned : pi - turned;
  };
  std::vector<AnglePair> pairs;
  for (const double view : {0.1, -0.7, pi - 0.5, pi + light + 1e-3}) {
    pairs.push_back({light, view, light, view});
    pairs.push_back({light, view, tilted(light), tilted(view)});
  }
  return pairs_request(pairs);
}

}  // namespace

TEST_CASE("layered transport: a divided slab equals the undivided one") {
  for (const auto& [g, albedo] : {std::pair{0.0, 1.0}, {0.7, 0.95}}) {
    const Scene whole = tests::hg_slab(60, {10, g, albedo}, some_pairs());
    const Scene cut =
        layered({{7, 0.7, g, albedo}, {33, 3.3, g, albedo}, {20, 2, g, albedo}}, some_pairs());
    for (const bool reversed : {false, true}) {
      if (!is_night && reversed != (g > 0)) continue;
      const auto expected = slab_covariance(whole, reversed, {1e-6}).value,
                 found = slab_covariance(cut, reversed, {1e-5}).value;
      for (std::size_t e = 0; e < found.size(); ++e) {
        CAPTURE(e);
        CHECK(std::abs(found[e] - expected[e]) < 5e-5 * std::abs(expected[e / 2 * 2]));
      }
    }
  }
}

TEST_CASE("layered transport: different layers, some absorbing, agree with Monte Carlo") {
  const Scene scene = layered({{20, 2, 0.8, 0.99}, {30, 0.5, 0, 0}, {10, 1, 0, 1}}, some_pairs());
  const auto expected = slab_covariance(scene, true, {precision}).value;
  const auto found = tests::run(scene, ReversedPaths::yes, is_night ? 60000 : 20000, 3).entries();
  for (std::size_t e = 0; e < expected.size(); ++e) {
    CAPTURE(e);
    CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected[e],
                         2 * precision * std::abs(expected[e / 2 * 2]));
    CHECK(found.error[e] < 0.05 * std::abs(expected[e / 2 * 2]));
  }
}

TEST_CASE("layered transport: temporal correlation of a divided slab equals the undivided one's") {
  const double delay = 0.03;
  const Scene whole = tests::hg_slab(60, {10, 0.7, 0.95}, some_pairs());
  const Scene cut = layered({{20, 2, 0.7, 0.95}, {40, 4, 0.7, 0.95}}, some_pairs());
  const auto expected = slab_covariance(whole, true, {1e-6}, {.delay = delay}).value,
             found = slab_covariance(cut, true, {1e-5}, {.delay = delay}).value;
  for (std::size_t e = 0; e < found.size(); ++e) {
    CAPTURE(e);
    CHECK(std::abs(found[e] - expected[e]) < 5e-5 * std::abs(expected[e / 2 * 2]));
  }
}

TEST_CASE("layered transport: layers of different diffusion agree with Monte Carlo") {
  const double delay = 0.05;
  Scene scene = layered({{20, 2, 0.8, 0.99}, {10, 1, 0, 1}},
                        intensity_request({0.3}, tests::far_views({0.1, pi - 0.5})));
  auto materials = scene.profile->materials();
  materials[0].motion.diffusion = 4;
  materials[1].motion.diffusion = 0.25;
  scene.profile = std::make_shared<const Layers>(materials, std::vector<double>{20, 10});
  const auto expected = slab_covariance(scene, true, {precision}, {.delay = delay}).value;
  const PathJob job = delay_job(scene, make_plan(scene, ReversedPaths::yes), {delay}, 5);
  const auto found = jackknife(tests::summed(job.field.batches, is_night ? 60000 : 20000), job.all);
  for (std::size_t e = 0; e < expected.size(); ++e) {
    CAPTURE(e);
    const std::size_t later = expected.size() + e;
    CHECK_WITHIN_4_SIGMA(found.value[later], found.error[later], expected[e],
                         precision * std::abs(expected[e]));
  }
}

// expected: discrete ordinates by adding and doubling, to six digits, without direct light.
TEST_CASE("layered transport: flux of three layers agrees with adding and doubling") {
  Scene scene = layered({{20, 2, 0.9, 0.99}, {30, 3, 0.7, 0.9}, {10, 1, 0, 1}},
                        intensity_request({0, 1}, tests::far_views({0})));
  const auto found = slab_flux(scene, 4, {1e-6}).value;
  const std::size_t per_light = found.size() / 2;
  const double expected[2][2] = {{0.286583, 0.294708}, {0.417927, 0.193188}};
  for (std::size_t light = 0; light < 2; ++light) {
    CAPTURE(light);
    const auto* shares = &found[light * per_light];
    CHECK(shares[reflected].real() == doctest::Approx(expected[light][0]).epsilon(5e-6));
    CHECK(shares[transmitted].real() == doctest::Approx(expected[light][1]).epsilon(5e-6));
  }
}

TEST_CASE("layered transport: near endpoints are rejected") {
  const Scene near = layered({{20, 2, 0.8, 1}}, intensity_request({0.0}, {near_sensor({0, 80})}));
  CHECK_THROWS_AS(slab_covariance_job(near, false, {1e-4}), InputError);
}

}  // namespace flatspeckle::mc::test_layered_transport
