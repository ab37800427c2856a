#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/quadrature.h"
#include "bench/oracles/slab_theory.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_slab_theory {

namespace {

using tests::pi;
using Channel = oracles::IsotropicSlab::Channel;

constexpr double k = 2 * pi;

/// Slab for the estimator and for theory.
struct Comparison {
  double depth, optical_depth, albedo;

  oracles::IsotropicSlab theory() const { return {k, depth, optical_depth / depth, albedo}; }
  Estimate estimate(const CovarianceRequest& request, ReversedPaths reversed, std::uint64_t paths,
                    std::uint64_t seed) const {
    const Scene scene = tests::hg_slab(depth, {depth / optical_depth, 0, albedo}, request);
    return tests::run(scene, reversed, paths, seed).entries();
  }
};

Channel channel(const CovarianceRequest& request, std::size_t number) {
  const auto c = request.channels[number];
  return {request.lights[c.light].angle, request.views[c.view].angle};
}

void check_entries(const Comparison& slab, const CovarianceRequest& request, ReversedPaths reversed,
                   std::uint64_t paths, std::uint64_t seed) {
  CAPTURE(slab.optical_depth);
  CAPTURE(slab.albedo);
  const auto theory = slab.theory();
  const Estimate found = slab.estimate(request, reversed, paths, seed);
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    const Channel a = channel(request, request.entries[e].a);
    const Channel b = channel(request, request.entries[e].b);
    const Complex expected =
        reversed == ReversedPaths::yes ? theory.with_reversed(a, b) : theory.without_reversed(a, b);
    INFO("light ", a.light, ", view ", a.view, "; light ", b.light, ", view ", b.view);
    CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected, 3e-4 * std::abs(expected));
    const double most = 0.05 * std::abs(expected) + 1e-4;  // so that the test is significant
    CHECK(found.error[e] < tests::effort().errors * most);
  }
}

}  // namespace

TEST_CASE("slab theory: conserves energy") {
  for (const double optical_depth : {0.1, 1.0, 10.0}) {
    for (const double light : {0.0, 1.1}) {
      const oracles::IsotropicSlab slab(k, 10, optical_depth / 10, 1);
      oracles::GaussPanels views;
      for (const double side : {0.0, pi}) {
        views.add(side - pi / 2, side, 8);
        views.add(side, side + pi / 2, 8);
      }
      double scattered = 0;
      for (std::size_t i = 0; i < views.node.size(); ++i) {
        const Channel c{light, views.node[i]};
        scattered += views.weight[i] * slab.without_reversed(c, c).real();
      }
      const double extinguished = std::cos(light) * -std::expm1(-optical_depth / std::cos(light));
      CHECK(scattered == doctest::Approx(extinguished).epsilon(1e-3));
    }
  }
}

TEST_CASE("isotropic slab: intensities in every direction agree with the integral equation") {
  const auto request =
      intensity_request({0, 0.9}, tests::far_views({0, 0.1, -1.2, 1.5, pi - 0.3, pi, -2.0, 1.65}));
  check_entries({20, 0.1, 1}, request, ReversedPaths::no, 40000, 1);
  check_entries({20, 1, 1}, request, ReversedPaths::no, 100000, 2);
  check_entries({20, 10, 1}, request, ReversedPaths::no, 50000, 3);
  check_entries({20, 1, 0.8}, request, ReversedPaths::no, 100000, 4);
  check_entries({20, 10, 0.95}, request, ReversedPaths::no, 50000, 5);
}

TEST_CASE("isotropic slab: the memory effect agrees with the integral equation") {
  // q L = 1 and 4 at depth 20; normal and oblique, transmission and reflection
  const std::vector<double> tilts = {0.008, -0.03};
  check_entries({20, 5, 1}, memory_effect_request(k, 0, {0, 0.6}, tilts), ReversedPaths::no, 80000,
                11);
  check_entries({20, 5, 0.9}, memory_effect_request(k, 0.5, {0.5, -0.2}, tilts), ReversedPaths::no,
                80000, 12);
  check_entries({20, 5, 1}, memory_effect_request(k, 0.3, {pi - 0.5, pi + 0.1}, tilts),
                ReversedPaths::no, 80000, 13);
}

TEST_CASE("isotropic slab: coherent backscattering agrees with the crossed integral equation") {
  // k mean free path = 25: the cone is about 0.03 wide
  const double light = 0.2, back = light + pi;
  const auto cone = intensity_request(
      {light},
      tests::far_views({back, back + 0.01, back - 0.03, back + 0.1, back - 0.6, 0.2, -0.4}));
  check_entries({20, 5, 1}, cone, ReversedPaths::yes, 60000, 21);
  check_entries({20, 5, 0.8}, cone, ReversedPaths::yes, 60000, 22);
  const std::vector<double> tilts = {0.004, -0.02};
  check_entries({20, 5, 1}, memory_effect_request(k, light, {back, back + 0.01}, tilts),
                ReversedPaths::yes, 60000, 23);
}

TEST_CASE("exact backscattering: reversed paths double all but single scattering") {
  const Comparison slab{20, 5, 1};
  const auto request = intensity_request({0.4}, tests::far_views({0.4 + pi, 0.4 + pi - 0.8}));
  const auto with = slab.estimate(request, ReversedPaths::yes, 100000, 31);
  const auto without = slab.estimate(request, ReversedPaths::no, 100000, 32);
  const Channel back{0.4, 0.4 + pi};
  const Complex single = slab.theory().single(back, back);
  CHECK_WITHIN_4_SIGMA(with.value[0] - single, std::hypot(with.error[0], 2 * without.error[0]),
                       2.0 * (without.value[0] - single), 0);
  // far outside the cone: terms of order 1/(k mean free path)^2
  CHECK_WITHIN_4_SIGMA(with.value[1], std::hypot(with.error[1], without.error[1]), without.value[1],
                       0.01 * std::abs(without.value[1]));
}

TEST_CASE(
    "exact backscattering, peaked scattering: reversed paths double all but single scattering") {
  const double depth = 20, g = 0.6, light = 0.4;
  const auto request = intensity_request({light}, tests::far_views({light + pi}));
  const Scene scene = tests::hg_slab(depth, {depth / 8, g, 0.95}, request);
  const auto with = tests::run(scene, ReversedPaths::yes, 200000, 33).entries();
  const auto without = tests::run(scene, ReversedPaths::no, 200000, 34).entries();
  // p(pi) instead of 1/(2 pi)
  const oracles::IsotropicSlab isotropic(k, depth, 8 / depth, 0.95);
  const Channel back{light, light + pi};
  const Complex single = (1 - g) / (1 + g) * isotropic.single(back, back);
  CHECK_WITHIN_4_SIGMA(with.value[0] - single, std::hypot(with.error[0], 2 * without.error[0]),
                       2.0 * (without.value[0] - single), 0);
  CHECK(with.error[0] < 0.02 * with.value[0].real());
}

TEST_CASE("isotropic slab with k depth = 1e6: covariances agree with the integral equation") {
  const double depth = 1e6 / k, tilt = 1e-6;
  check_entries({depth, 2, 1}, memory_effect_request(k, 0.5, {0.5, 0.1}, {tilt, -2 * tilt}),
                ReversedPaths::no, 60000, 41);
  const Comparison slab{depth, 2, 1};
  const auto request = intensity_request({0.5}, tests::far_views({0.5 + pi}));
  const auto found = slab.estimate(request, ReversedPaths::yes, 60000, 42);
  const Channel back{0.5, 0.5 + pi};
  const auto theory = slab.theory();
  CHECK_WITHIN_4_SIGMA(found.value[0], found.error[0],
                       theory.single(back, back) + 2.0 * theory.ladder(back, back), 1e-4);
}

}  // namespace flatspeckle::mc::test_slab_theory
