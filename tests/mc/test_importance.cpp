#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/slab_theory.h"
#include "bench/oracles/textbook.h"
#include "core/error.h"
#include "grin/media/scattering/diffusion_rate.h"
#include "mc/paths/walk/importance.h"
#include "mc/theory/diffusion.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_importance {

namespace {

using tests::pi;

constexpr double k = 2 * pi;

/// Compares transmitted and reflected intensities and a matched pair of an isotropic slab of depth
/// 10 with the integral equation. largest_error is relative, for intensities.
void check_slab(double optical_depth, double albedo, const std::vector<double>& views,
                const Plan& changed, std::uint64_t paths, double largest_error) {
  const double depth = 10;
  const auto request = memory_effect_request(k, 0, views, {0.02});
  const Scene scene = tests::hg_slab(depth, {depth / optical_depth, 0, albedo}, request);
  Plan plan = make_plan(scene, ReversedPaths::no);
  plan.weighted = changed.weighted;
  plan.score_level = changed.score_level;
  const auto found = tests::run(scene, plan, paths, 3).entries();
  const oracles::IsotropicSlab theory(k, depth, optical_depth / depth, albedo);
  const auto channel = [&](std::uint32_t c) {
    return oracles::IsotropicSlab::Channel{request.lights[request.channels[c].light].angle,
                                           request.views[request.channels[c].view].angle};
  };
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    const auto [a, b] = request.entries[e];
    const Complex expected = theory.without_reversed(channel(a), channel(b));
    CAPTURE(e);
    CAPTURE(plan.score_level);
    CAPTURE(plan.weighted);
    CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected, 1e-3 * std::abs(expected));
    if (a == b) CHECK(found.error[e] < largest_error * std::abs(expected));
  }
}

Plan with(double score_level, bool weighted) {
  Plan plan;
  plan.score_level = score_level;
  plan.weighted = weighted;
  return plan;
}

}  // namespace

TEST_CASE("diffusion rate: agrees with the transport equation") {
  // Isotropic scattering in the plane: 1 = albedo / sqrt(1 - rate^2).
  for (const double albedo : {0.01, 0.3, 0.8, 0.99, 1 - 1e-9})
    CHECK(grin::diffusion_rate(albedo, 0, 2) ==
          doctest::Approx(std::sqrt((1 - albedo) * (1 + albedo))).epsilon(1e-6));
  for (const double g : {-0.5, 0.5, 0.9}) {  // the diffusion limit
    const double absorbed = 1e-6;
    CHECK(grin::diffusion_rate(1 - absorbed, g, 2) ==
          doctest::Approx(std::sqrt(2 * absorbed * (1 - g))).epsilon(1e-3));
  }
  for (const double albedo : {0.3, 0.8, 0.99}) {  // in space 1 = albedo atanh(rate) / rate
    const double rate = grin::diffusion_rate(albedo, 0, 3);
    CHECK(albedo * std::atanh(rate) == doctest::Approx(rate).epsilon(1e-6));
  }
  CHECK(grin::diffusion_rate(1 - 1e-6, 0.9, 3) ==
        doctest::Approx(std::sqrt(3e-6 * 0.1)).epsilon(1e-3));
  CHECK(grin::diffusion_rate(1, 0.9, 2) == 0);
  CHECK(grin::diffusion_rate(0.9, 0.9, 2) > grin::diffusion_rate(0.9, 0.95, 2));
}

TEST_CASE("roulette of scores and depth windows: estimates are unbiased") {
  for (const double level : {0.0, 0.3, 5.0, 50.0})
    for (const bool weighted : {false, true})
      check_slab(3, 1, {0.1, pi - 0.2}, with(level, weighted), 60000, 0.2);
  for (const double level : {0.0, 2.0})
    check_slab(4, 0.7, {0.1, pi - 0.2}, with(level, true), 40000, 0.2);
}

TEST_CASE("deep absorbing media: estimates agree with the integral equation") {
  check_slab(30, 0.9, {0.1}, with(2, true), 80000, 0.1);
  check_slab(10, 0.5, {0}, with(2, true), 200000, 0.3);
  check_slab(100, 0.9, {pi - 0.4}, with(2, true), 40000, 0.05);
}

TEST_CASE("absorbing box with reversed paths: agrees with the textbook estimator") {
  const auto request = intensity_request({0, 0.4}, tests::far_views({0.2, 1.5, pi, pi - 0.4}));
  const Scene scene = tests::hg_box(12, 8, {2, 0.5, 0.7}, request);
  const auto found = tests::run(scene, ReversedPaths::yes, 200000, 5).entries();
  const FieldJob textbook = oracles::textbook_job(scene, true, 200, 6);
  const auto expected =
      jackknife(tests::summed(textbook.batches, tests::shortened(400000)), textbook.covariance);
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    CAPTURE(e);
    CHECK_WITHIN_4_SIGMA(found.value[e], std::hypot(found.error[e], expected.error[e]),
                         expected.value[e], 0.0);
  }
}

TEST_CASE("deep boxes: intensities do not depend on other lights and views or on their order") {
  // Each light reaches deep along a side where the other has no density; views do the same.
  const auto intensities = [](const std::vector<double>& lights, const std::vector<double>& views) {
    const auto request = intensity_request(lights, tests::far_views(views));
    return tests::run(tests::hg_box(20, 20, {1}, request), ReversedPaths::no, 100000, 9).entries();
  };
  const auto both = intensities({0.24, -0.24}, {1.2, 0.1, -0.1, -1.2});
  const auto alone = intensities({-0.24}, {0.1});
  for (std::size_t v = 0; v < 4; ++v)  // mirror images
    CHECK_WITHIN_4_SIGMA(both.value[v], std::hypot(both.error[v], both.error[7 - v]),
                         both.value[7 - v], 0.0);
  CHECK_WITHIN_4_SIGMA(both.value[5], std::hypot(both.error[5], alone.error[0]), alone.value[0],
                       0.0);
  CHECK(both.error[5] < 0.05 * both.value[5].real());
}

TEST_CASE("long paths: media whose paths would take seconds are rejected") {
  const auto request = intensity_request({0}, {far_view(0.3)});
  const auto box = [&](double width, double optical_depth, double albedo = 1) {
    return tests::hg_box(width, 20, {20 / optical_depth, 0, albedo}, request);
  };
  CHECK_NOTHROW(require_walks(box(100, 1e4), false));
  CHECK_NOTHROW(require_walks(box(100, 1e9, 0.9), false));  // absorption ends them
  CHECK_NOTHROW(require_walks(box(4, 1e3), true));
  for (const double optical_depth : {1e5, 1e9, 1e30})
    CHECK_THROWS_WITH_AS(require_walks(box(100, optical_depth), false),
                         doctest::Contains("longest light paths scatter"), InputError);
  CHECK_THROWS_WITH_AS(require_walks(box(1, 2e4), true), doctest::Contains("all that they split"),
                       InputError);
}

TEST_CASE("slowest diffusion mode: number of scatterings agrees with diffusion theory") {
  const auto request = intensity_request({0}, {far_view(0.3)});
  const auto scatterings = [](const Scene& scene) {
    return scatterings_of_slowest_mode(scene.medium, scene.domain);
  };
  const Scene lossless = tests::hg_slab(100, {1}, request);
  const double extent = 100 + 2 * 0.818;
  CHECK(scatterings(lossless) == doctest::Approx(2 * extent * extent / (pi * pi)));
  const Scene absorbing = tests::hg_slab(1e6, {1, 0, 0.9}, request);
  CHECK(scatterings(absorbing) == doctest::Approx(9).epsilon(1e-6));
}

TEST_CASE("narrow lossless box: transmission agrees with an almost lossless one") {
  const auto request = intensity_request({0}, {far_view(0)});
  const auto through = [&](double albedo) {
    return tests::run(tests::hg_box(10, tests::is_night ? 40 : 25, {1, 0, albedo}, request),
                      ReversedPaths::no, 100000, 9)
        .entries();
  };
  const auto lossless = through(1), nearly = through(1 - 1e-9);
  CHECK_WITHIN_4_SIGMA(lossless.value[0], std::hypot(lossless.error[0], nearly.error[0]),
                       nearly.value[0], 0.0);
  CHECK(lossless.error[0] < 0.1 * lossless.value[0].real());
}

}  // namespace flatspeckle::mc::test_importance
