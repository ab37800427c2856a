#include <cmath>

#include "tests/mc/flux_runs.h"

namespace flatspeckle::mc::test_flux_deep {

namespace {

using tests::is_night;
using tests::pi;

}  // namespace

TEST_CASE("flux at optical depth 100 (by day 15): agrees with discrete ordinates") {
  const double optical_depth = is_night ? 100 : 15;
  std::uint64_t seed = 100;
  for (const double g : {0.0, 0.9})
    for (const double albedo : {1.0, 0.9})
      if (is_night || (g == 0) == (albedo == 1))
        tests::check_slab(optical_depth, albedo, g, is_night ? 0.03 : 0.06, ++seed);
  tests::check_slab(100, 0.01, 0, is_night ? 0.03 : 0.06, ++seed);
}

TEST_CASE("flux of a thick lossless slab: transmittance agrees with diffusion theory") {
  // (l* + z0) / (L + 2 z0), z0 = 0.818 l* (C20)
  for (const double g : {0.0, 0.8}) {
    const double reach = 1 / (1 - g);
    const Scene scene = tests::lit_slab(100, 1, g, {0});
    const auto flux = tests::run_flux(scene, tests::paths(10000), 110).flux;
    const double expected = 1.818 * reach / (100 + 2 * 0.818 * reach);
    CHECK(flux.transmittance.error[0] < 0.005 * expected);
    CHECK(flux.transmittance.value[0].real() == doctest::Approx(expected).epsilon(0.03));
  }
}

TEST_CASE("flux at optical depth 100, g = 0.99: reflectance agrees with discrete ordinates") {
  const Scene scene = tests::lit_slab(100, 1, 0.99, {0});
  const auto flux = tests::run_flux(scene, tests::paths(40000), 120).flux;
  // discrete ordinates with 800 nodes per quadrant; 400 nodes give 0.31908
  const double expected = 0.31914;
  CHECK_WITHIN_4_SIGMA(flux.reflectance.value[0], flux.reflectance.error[0], expected, 1e-5);
  CHECK(flux.reflectance.error[0] < 0.01 * expected);
}

TEST_CASE("nightly: flux of slabs agrees with discrete ordinates to 0.1 %") {
  std::uint64_t seed = 200;
  for (const double optical_depth : {0.1, 1.0, 10.0})
    for (const double g : {0.0, 0.5, 0.9, -0.5})
      for (const double albedo : {1.0, 0.99, 0.5})
        tests::check_slab(optical_depth, albedo, g, 0.001, ++seed);
}

TEST_CASE(
    "nightly: flux through a lossless optical depth of 100 agrees with discrete ordinates to 0.1 "
    "%") {
  std::uint64_t seed = 300;
  for (const double g : {0.0, 0.5, 0.9, -0.5}) tests::check_slab(100, 1, g, 0.001, ++seed);
}

TEST_CASE(
    "nightly: flux through an absorbing optical depth of 100 agrees with discrete ordinates to 0.5 "
    "%") {
  tests::check_slab(100, 0.9, 0, 0.005, 401);
  tests::check_slab(100, 0.9, 0.9, 0.005, 402);
}

}  // namespace flatspeckle::mc::test_flux_deep
