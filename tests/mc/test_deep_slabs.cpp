#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/discrete_ordinates.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_deep_slabs {

namespace {

using tests::pi;

/// Compares intensities of a slab in transmission and reflection with discrete ordinates at `nodes`
/// nodes; largest_error is the relative error allowed.
void check_slab(double optical_depth, double g, double albedo, int nodes, std::uint64_t paths,
                double largest_error) {
  const std::vector<double> lights = {0, 0.7}, views = {0.1, -1, pi - 0.2, 2.2};
  const auto request = intensity_request(lights, tests::far_views(views));
  const double depth = 10;
  const auto found = tests::run(tests::hg_slab(depth, {depth / optical_depth, g, albedo}, request),
                                ReversedPaths::no, paths, 11)
                         .entries();
  std::vector<double> angles = lights;
  angles.insert(angles.end(), views.begin(), views.end());
  const oracles::SlabTransport theory({optical_depth, albedo, oracles::henyey_greenstein(g)},
                                      angles, nodes);
  for (std::size_t c = 0; c < request.channels.size(); ++c) {
    const double light = lights[request.channels[c].light], view = views[request.channels[c].view];
    const double expected = theory.covariance_without_reversed(light, view);
    CAPTURE(optical_depth);
    CAPTURE(g);
    CAPTURE(albedo);
    CAPTURE(light);
    CAPTURE(view);
    CHECK_WITHIN_4_SIGMA(found.value[c], found.error[c], expected, 5e-4 * expected);
    CHECK(found.error[c] < largest_error * tests::effort().errors * expected);
  }
}

}  // namespace

TEST_CASE("thin slabs: intensities agree with discrete ordinates") {
  for (const double g : {0.0, 0.9}) check_slab(1e-3, g, 1, 80, 40000, 0.02);
}

TEST_CASE("forward-peaked slabs: intensities agree with discrete ordinates") {
  check_slab(10, 0.9, 1, 80, 400000, 0.02);
  check_slab(10, 0.9, 0.9, 80, 400000, 0.02);
}

TEST_CASE("deep slabs, g = 0.99 (by day 0.97): intensities agree with discrete ordinates") {
  tests::is_night ? check_slab(100, 0.99, 1, 300, 100000, 0.1)
                  : check_slab(30, 0.97, 1, 150, 200000, 0.03);
}

TEST_CASE(
    "deep absorbing slabs transmitting 1e-9 and less: intensities agree with discrete ordinates") {
  check_slab(30, 0, 0.7, 60, 200000, 0.05);
  check_slab(40, 0.3, 0.6, 60, 200000, 0.05);
}

TEST_CASE(
    "lossless isotropic slab of optical depth 100 (by day 30): intensities agree with discrete "
    "ordinates") {
  check_slab(tests::is_night ? 100 : 30, 0, 1, 40, 100000, tests::is_night ? 0.1 : 0.04);
}

}  // namespace flatspeckle::mc::test_deep_slabs
