#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/quadrature.h"
#include "bench/oracles/slab_theory.h"
#include "mc/paths/endpoint_factors/coherent_field.h"
#include "mc/theory/memory_effect.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_extremes {

namespace {

using tests::pi;

constexpr double k = 2 * pi;

bool all_finite(const Estimate& estimate) {
  bool finite = true;
  for (std::size_t e = 0; e < estimate.value.size(); ++e)
    finite =
        finite && std::isfinite(std::abs(estimate.value[e])) && std::isfinite(estimate.error[e]);
  return finite;
}

/// Compares intensities of an isotropic slab of depth 10 with the integral equation.
void check_slab(double optical_depth, double albedo, const std::vector<double>& lights,
                const std::vector<double>& views, ReversedPaths reversed, std::uint64_t paths,
                std::uint64_t seed) {
  const double depth = 10;
  const auto request = intensity_request(lights, tests::far_views(views));
  const auto found = tests::run(tests::hg_slab(depth, {depth / optical_depth, 0, albedo}, request),
                                reversed, paths, seed)
                         .entries();
  const oracles::IsotropicSlab theory(k, depth, optical_depth / depth, albedo);
  for (std::size_t c = 0; c < request.channels.size(); ++c) {
    const oracles::IsotropicSlab::Channel channel{lights[request.channels[c].light],
                                                  views[request.channels[c].view]};
    const Complex expected = reversed == ReversedPaths::yes
                                 ? theory.with_reversed(channel, channel)
                                 : theory.without_reversed(channel, channel);
    CAPTURE(optical_depth);
    CAPTURE(channel.light);
    CAPTURE(channel.view);
    CHECK_WITHIN_4_SIGMA(found.value[c], found.error[c], expected, 1e-3 * std::abs(expected));
    CHECK(found.error[c] < 0.1 * std::abs(expected));
  }
}

}  // namespace

TEST_CASE("optical depth 1e-3: intensities agree with the integral equation") {
  check_slab(1e-3, 1, {0, 0.8}, {0.1, -1, pi, 2.2}, ReversedPaths::yes, 32000, 1);
}

TEST_CASE("optical depth 100: intensities agree with the integral equation") {
  check_slab(100, 1, {0}, {0.1, -1, 2.2}, ReversedPaths::no, 32000, 2);
}

TEST_CASE("albedo 1 - 1e-9: intensities agree with the integral equation") {
  check_slab(5, 1 - 1e-9, {0}, {0.1, pi}, ReversedPaths::no, 32000, 3);
}

TEST_CASE("grazing light and views: intensities agree with the integral equation") {
  check_slab(1, 1, {1.5}, {0.1, 1.54, -1.54, 1.61, pi + 1.5}, ReversedPaths::no, 64000, 4);
}

TEST_CASE("infinite slab: views along it are 0") {
  const auto request = intensity_request({0, 1.5}, tests::far_views({pi / 2, -pi / 2}));
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no}) {
    const auto found = tests::run(tests::hg_slab(10, {5}, request), reversed, 8000, 5).entries();
    for (const Complex value : found.value) CHECK(value == 0.0);
  }
}

TEST_CASE("no scattering: covariance, correlation and errors are 0") {
  const auto request = memory_effect_request(k, 0, {0.1, pi}, {0.0, 0.01});
  SceneSpec empty;
  empty.width = 20;
  empty.depth = 10;
  empty.count = 0;
  Scene empty_box = make_scene(empty);
  empty_box.request = request;
  for (const Scene& scene : {empty_box, tests::hg_box(20, 10, {4, 0.5, 0}, request),
                             tests::hg_slab(10, {4, 0, 0}, request)}) {
    const auto result = tests::run(scene, ReversedPaths::automatic, 8000, 6);
    for (const Complex value : result.entries().value) CHECK(value == 0.0);
    for (const double error : result.entries().error) CHECK(error == 0);
    const auto effect = memory_effect(request, result.sums, result.job.covariance);
    for (const double value : effect.correlation) CHECK(value == 0);
    CHECK(result.job.batches.relative_error(result.sums) == 0);
  }
  for (const Complex value : coherent_field(empty_box)) CHECK(value == 0.0);
}

TEST_CASE("thinnest media: double scattering is sampled") {
  const auto request = intensity_request({0}, tests::far_views({0.4, 2}));
  for (const double optical_depth : {1e-12, 1e-9, 1e-6}) {
    CAPTURE(optical_depth);
    const Scene slab = tests::hg_slab(10, {10 / optical_depth, 0, 0.9}, request);
    const auto found = tests::run(slab, ReversedPaths::no, 40000, 7).entries();
    for (std::size_t e = 0; e < found.value.size(); ++e) {
      CHECK(found.error[e] > 0.01 * optical_depth * found.value[e].real());
      CHECK(found.error[e] < optical_depth * found.value[e].real());
    }
  }
}

TEST_CASE("extreme asymmetry: intensities are finite and conserve power") {
  for (const double g : {-0.999, 0.999}) {
    // fine panels around the lobes at 0 and pi, coarse ones elsewhere
    oracles::GaussPanels views;
    for (const double lobe : {0.0, pi}) {
      double inner = 0;
      for (const double outer : {0.002, 0.01, 0.05, 0.3, pi / 2}) {
        views.add(lobe + inner, lobe + outer, 2);
        views.add(lobe - outer, lobe - inner, 2);
        inner = outer;
      }
    }
    const auto request = intensity_request({0}, tests::far_views(views.node));
    for (const double optical_depth : {0.01, 2.0}) {
      const Scene scene = tests::hg_slab(10, {10 / optical_depth, g}, request);
      const auto result = tests::run(scene, ReversedPaths::no, 64000, 7);
      CAPTURE(g);
      CAPTURE(optical_depth);
      CHECK(all_finite(result.entries()));
      const auto power = result.weighted_sum(views.weight);
      const double expected = -std::expm1(-optical_depth);
      CHECK_WITHIN_4_SIGMA(power.value[0], power.error[0], expected, 2e-3 * expected);
    }
  }
}

TEST_CASE("intensities without reversed paths: independent of the wavelength") {
  const std::vector<double> views = {0.1, 1.5, pi};
  const auto request = intensity_request({0, -0.7}, tests::far_views(views));
  const tests::HgBulk bulk{4, 0.5, 1};
  const auto long_waves =
      tests::run(tests::hg_box(20, 10, bulk, request), ReversedPaths::no, 4000, 8).entries();
  const auto short_waves =  // k depth = 6e6
      tests::run(tests::hg_box(20, 10, bulk, request, 1e-5), ReversedPaths::no, 4000, 8).entries();
  for (std::size_t e = 0; e < request.entries.size(); ++e)
    CHECK(std::abs(short_waves.value[e] - long_waves.value[e]) <
          1e-12 * std::abs(long_waves.value[e]));
}

TEST_CASE("needle- and sheet-like boxes: covariances along their edges are finite") {
  const auto request =
      full_request({0, pi / 2, pi, 1.5707}, tests::far_views({0, pi / 2, pi, -pi / 2}));
  for (const auto& [width, depth] : {std::pair{1e-3, 1e3}, {1e3, 1e-3}, {1e-6, 1e-6}}) {
    const auto found = tests::run(tests::hg_box(width, depth, {1, 0.5, 0.9}, request),
                                  ReversedPaths::yes, 16000, 9)
                           .entries();
    CHECK(all_finite(found));
    const std::size_t back = 2;  // light 0, view pi
    CHECK(found.value[back * (back + 1) / 2 + back].real() > 0);
  }
}

}  // namespace flatspeckle::mc::test_extremes
