#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/discrete_ordinates.h"
#include "bench/oracles/slab_theory.h"
#include "mc/theory/memory_effect.h"
#include "tests/mc/estimates.h"
#include "tests/oracles/pair_transport.h"

namespace flatspeckle::mc::test_pair_transport {

namespace {

using oracles::henyey_greenstein;
using oracles::PairTransport;

constexpr double k = 2 * tests::pi, depth = 1000;

double tilted(double angle, double q) {
  return std::asin(std::sin(angle) + q / k);
}

/// |C| and C_E of a memory effect along the normal, per tilt.
struct Expected {
  std::vector<double> magnitude, correlation;
};

Expected memory_effect_in_theory(double optical_depth, double g, double albedo,
                                 const std::vector<double>& tilts, int panels) {
  const PairTransport::Medium medium{k, depth, optical_depth / depth, albedo, henyey_greenstein(g)};
  const auto at = [&](double first, double second) {
    return std::abs(
        PairTransport(medium, {{first, second}}, {{first, second}}, panels).covariance(0, 0));
  };
  const double reference = at(0, 0);
  Expected expected;
  for (const double tilt : tilts) {
    expected.magnitude.push_back(at(0, tilt));
    expected.correlation.push_back(expected.magnitude.back() /
                                   std::sqrt(reference * at(tilt, tilt)));
  }
  return expected;
}

void check_memory_effect(double optical_depth, double g, double albedo, int panels,
                         std::uint64_t paths) {
  CAPTURE(optical_depth);
  CAPTURE(g);
  CAPTURE(albedo);
  std::vector<double> tilts;
  for (const double q : {1.0, 3.0, 8.0}) tilts.push_back(tilted(0, q / depth));
  const auto expected = memory_effect_in_theory(optical_depth, g, albedo, tilts, panels);
  const auto request = memory_effect_request(k, 0, {0}, tilts);
  const Scene scene = tests::hg_slab(depth, {depth / optical_depth, g, albedo}, request);
  const auto found = tests::run(scene, ReversedPaths::automatic, paths, 5);
  const auto entries = found.entries();
  const auto effect = memory_effect(request, found.sums, found.job.covariance);
  for (std::size_t t = 0; t < tilts.size(); ++t) {
    CAPTURE(t);
    CHECK_WITHIN_4_SIGMA(std::abs(entries.value[t]), entries.error[t], expected.magnitude[t],
                         3e-4 * expected.magnitude[t]);
    CHECK_WITHIN_4_SIGMA(effect.correlation[t], effect.correlation_error[t],
                         expected.correlation[t], 3e-4);
    CHECK(effect.correlation_error[t] < 0.02 * tests::effort().errors);
  }
}

}  // namespace

TEST_CASE("pair transport: tilts of isotropic slabs agree with the integral equation") {
  for (const double light : {0.0, 0.4}) {
    for (const double tilt : {0.0, 1.0, -5.0, 20.0}) {  // q L
      const double q = tilt / depth, optical_depth = 3, view = -0.2;
      const PairTransport transport({k, depth, optical_depth / depth, 0.9, henyey_greenstein(0)},
                                    {{light, tilted(light, q)}}, {{view, tilted(view, q)}}, 4);
      const oracles::IsotropicSlab theory(k, depth, optical_depth / depth, 0.9);
      const Complex expected =
          theory.without_reversed({light, view}, {tilted(light, q), tilted(view, q)});
      CAPTURE(light);
      CAPTURE(tilt);
      CHECK(std::abs(transport.covariance(0, 0) - expected) < 3e-4 * std::abs(expected));
    }
  }
}

TEST_CASE("pair transport: without a tilt it equals transport of intensity") {
  for (const double g : {-0.4, 0.8}) {
    for (const double optical_depth : {0.5, 20.0}) {
      const PairTransport transport({k, depth, optical_depth / depth, 0.97, henyey_greenstein(g)},
                                    {{0, 0}, {0.5, 0.5}}, {{0.3, 0.3}, {-0.7, -0.7}}, 4);
      const oracles::SlabTransport intensity({optical_depth, 0.97, henyey_greenstein(g)},
                                             {0, 0.5, 0.3, -0.7}, 60);
      const double lights[] = {0, 0.5}, views[] = {0.3, -0.7};
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t v = 0; v < 2; ++v)
          CHECK(transport.covariance(i, v).real() ==
                doctest::Approx(intensity.covariance_without_reversed(lights[i], views[v]))
                    .epsilon(1e-4));
    }
  }
}

TEST_CASE("memory effect of forward-peaked scatterers: Monte Carlo agrees with pair transport") {
  check_memory_effect(5, 0.5, 0.95, 4, 100000);
  check_memory_effect(10, 0.8, 1, 5, 100000);
  if (tests::is_night) check_memory_effect(5, 0.9, 0.9, 8, 100000);
  check_memory_effect(30, 0.8, 0.8, 5, 100000);
}

}  // namespace flatspeckle::mc::test_pair_transport
