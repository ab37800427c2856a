#include <cmath>
#include <functional>

#include <doctest/doctest.h>

#include "bench/oracles/discrete_ordinates.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/theory/memory_effect.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_error_bars {

namespace {

using tests::is_night;
using tests::pi;

const int paths = is_night ? 4000 : 1600;

Scene box_points(const CovarianceRequest& request) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.count = 31;
  Scene scene = make_scene(spec);
  scene.request = request;
  return scene;
}

/// Returns, per value, the root-mean-square spread of `estimate_of` over many seeds divided by the
/// reported error. The spread of 200 normal numbers is accurate to 5 %.
std::vector<double> spread_over_error(const std::function<Estimate(std::uint64_t)>& estimate_of) {
  constexpr int runs = 200;
  std::vector<Estimate> estimates;
  for (int i = 0; i < runs; ++i) estimates.push_back(estimate_of(1000 + i));
  std::vector<double> ratios;
  for (std::size_t e = 0; e < estimates[0].value.size(); ++e) {
    Complex mean = 0;
    double reported = 0, spread = 0;
    for (const auto& one : estimates) {
      mean += one.value[e] / static_cast<double>(runs);
      reported += one.error[e] * one.error[e] / runs;
    }
    for (const auto& one : estimates) spread += std::norm(one.value[e] - mean) / (runs - 1);
    ratios.push_back(std::sqrt(spread / reported));
  }
  return ratios;
}

}  // namespace

TEST_CASE("error bars: agree with the spread of estimates over seeds") {
  const Scene resonant = box_points(memory_effect_request(2 * pi, 0, {0.1, pi}, {0.04}));
  // peaked scattering in backscattering, and a sensor a twentieth of a wavelength off the edge
  const Scene peaked = tests::hg_box(
      20, 10, {4, 0.9, 0.9}, full_request({0, 0.5}, {far_view(pi), near_sensor({1, 10.05})}));
  for (const Scene& scene : {resonant, peaked}) {
    const auto ratios = spread_over_error([&](std::uint64_t seed) {
      return tests::run(scene, ReversedPaths::yes, paths, seed, paths / 40).entries();
    });
    for (const double ratio : ratios) CHECK(ratio == doctest::Approx(1).epsilon(0.15));
  }
}

TEST_CASE("error bars: cover the exact value behind deep absorbing slabs") {
  // If rare paths dominate, most runs miss them: values and errors are too small.
  const double optical_depth = 30, albedo = 0.6;
  const Scene scene =
      tests::hg_slab(10, {10 / optical_depth, 0, albedo}, intensity_request({0}, {far_view(0)}));
  const oracles::SlabTransport theory({optical_depth, albedo, oracles::henyey_greenstein(0)}, {0},
                                      60);
  const double expected = theory.covariance_without_reversed(0, 0);
  const int runs = is_night ? 200 : 100;
  int within = 0;
  double sum = 0;
  for (int i = 0; i < runs; ++i) {
    const auto found =
        tests::run(scene, ReversedPaths::no, is_night ? 12800 : 3200, i, is_night ? 100 : 25)
            .entries();
    within += std::abs(found.value[0] - expected) < 2 * found.error[0];
    sum += found.value[0].real() / runs;
  }
  CHECK(within > (is_night ? 0.9 : 0.85) * runs);
  CHECK(sum == doctest::Approx(expected).epsilon(0.02));
}

TEST_CASE("error bars of the modulus of a complex correlation: agree with the spread over seeds") {
  // Shear turns the phase; the error of the complex correlation is up to twice that of its modulus.
  const Scene scene =
      tests::hg_slab(50, {10, 0.6}, intensity_request({0}, tests::far_views({0.2, pi - 0.5})));
  const std::vector<double> delays = {0.1, 0.4};
  double widest = 0;
  const auto ratios = spread_over_error([&](std::uint64_t seed) {
    const PathJob own =
        delay_job(scene, make_plan(scene, ReversedPaths::no), delays, seed, {0.5, {}, 0.06});
    const auto sums = tests::summed(own.field.batches, 4 * paths);
    const auto found = change_estimates(scene.request, own, sums);
    for (std::size_t i = 0; i < found.magnitude.value.size(); ++i)
      widest = std::max(widest, found.correlation.error[i] / found.magnitude.error[i]);
    return found.magnitude;
  });
  CHECK(widest > 1.5);
  for (const double ratio : ratios) CHECK(ratio == doctest::Approx(1).epsilon(0.15));
}

TEST_CASE("error bars of the memory effect and its range: agree with the spread over seeds") {
  const auto request =
      memory_effect_request(2 * pi, 0, {0, 0.3}, {0.005, 0.01, 0.02, 0.03, 0.04, 0.06});
  const Scene scene = tests::hg_slab(10, {2, 0.5}, request);
  const auto ratios = spread_over_error([&](std::uint64_t seed) {
    const auto result = tests::run(scene, ReversedPaths::no, paths, seed, paths / 40);
    const auto effect = memory_effect(request, result.sums, result.job.covariance);
    Estimate estimate{{effect.correlation.begin(), effect.correlation.end()},
                      effect.correlation_error};
    estimate.value.emplace_back(effect.range.range.value);
    estimate.error.push_back(effect.range.error);
    CHECK(effect.range.range.censored == Range::Censoring::none);
    return estimate;
  });
  for (const double ratio : ratios) CHECK(ratio == doctest::Approx(1).epsilon(0.15));
}

}  // namespace flatspeckle::mc::test_error_bars
