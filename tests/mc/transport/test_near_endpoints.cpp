#include <cmath>
#include <numbers>
#include <vector>

#include "tests/mc/transport/slabs.h"

namespace flatspeckle::mc::test_near_endpoints {

namespace {

using std::numbers::pi;
using tests::hg_box, tests::hg_slab, tests::wavenumber;

/// Compares transport in a slab with Monte Carlo in a box so wide that no light reaches its sides.
void check_against_box(double width, double depth, const tests::HgBulk& bulk,
                       const CovarianceRequest& request, ReversedPaths reversed,
                       std::uint64_t paths, double precise) {
  const bool with_reversed = reversed == ReversedPaths::yes;
  const auto expected = slab_covariance(hg_slab(depth, bulk, request), with_reversed, {1e-4}).value;
  const auto found = tests::run(hg_box(width, depth, bulk, request), reversed, paths, 1).entries();
  for (std::size_t e = 0; e < expected.size(); ++e) {
    CAPTURE(e);
    CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected[e], 0);
    if (request.entries[e].a == request.entries[e].b)
      CHECK(found.error[e] < precise * tests::effort().errors * std::abs(expected[e]));
  }
}

}  // namespace

TEST_CASE("slab transport of beams: entries without common directions are 0") {
  const auto request = full_request({{gaussian_beam(0.2, {0, -3}, 8)}}, far_views({1.4, -1.4}));
  const auto found = slab_covariance(hg_slab(20, {10, 0.3, 0.9}, request), false, {});
  CHECK(found.value[0].real() > 0);
  CHECK(found.value[1] == 0.0);
  CHECK(found.value[2].real() > 0);
}

TEST_CASE("Monte Carlo: near endpoints outside a slab are rejected") {
  const Scene beside =
      hg_slab(20, {10, 0.3, 0.9}, intensity_request({{point_source({0, -3})}}, far_views({0.1})));
  CHECK_THROWS_AS(tests::run(beside, ReversedPaths::no, 800, 1), InputError);
}

TEST_CASE("wide beam on a slab: equals a plane wave of its width") {
  constexpr double depth = 20, waist = 3000;
  const tests::HgBulk bulk{10, 0.3, 0.9};
  const std::vector<double> views = {0.3, pi - 0.5};
  const Light beam = gaussian_beam(0.2, {5, -3}, waist);
  const auto found = slab_covariance(
      hg_slab(depth, bulk, intensity_request({{beam}}, far_views(views))), false, {});
  const auto plane =
      slab_covariance(hg_slab(depth, bulk, intensity_request({0.2}, far_views(views))), false, {});
  // int |u|^2 dx over the slab's face, which the axis meets at an angle
  const double width = waist * std::sqrt(pi / 2) / std::cos(0.2);
  for (std::size_t v = 0; v < views.size(); ++v)
    CHECK(std::abs(found.value[v] / (width * plane.value[v]) - 1.0) < 1e-5);
}

TEST_CASE("beams on a thin slab: agree with single scattering in closed form") {
  constexpr double depth = 10, waist = 20, shift = 15, thickness = 1e-3;
  const auto beam_at = [](double x) { return gaussian_beam(0, {x, 0}, waist); };
  const std::vector<double> views = {0.2, 0.205};
  const auto request = full_request({{beam_at(0), beam_at(shift)}}, far_views(views));
  const auto found = slab_covariance(hg_slab(depth, {depth / thickness, 0, 1}, request), false, {});
  const double once = thickness * waist * std::sqrt(pi / 2) / (2 * pi),
               q = wavenumber * (std::sin(views[0]) - std::sin(views[1])),
               along = wavenumber * (std::cos(views[0]) - std::cos(views[1])) * depth / 2,
               apart = std::exp(-q * q * waist * waist / 8) * std::sin(along) / along,
               moved = std::exp(-shift * shift / (2 * waist * waist));
  // lower triangle of [light][view]; double scattering is a percent
  CHECK(std::abs(found.value[0] / once - 1.0) < 0.01);
  CHECK(std::abs(std::abs(found.value[1]) / once - apart) < 0.01 * apart);
  CHECK(std::abs(std::abs(found.value[3]) / once - moved) < 0.01 * moved);
}

TEST_CASE("beams on a slab: transport agrees with Monte Carlo in a wide box") {
  constexpr double depth = 20;
  const Light beam = gaussian_beam(0.2, {0, -30}, 8), moved = gaussian_beam(0.2, {4, -30}, 8);
  check_against_box(1500, depth, {10, 0.3, 0.9},
                    full_request({{beam, moved}}, far_views({0.1, 0.13, pi - 0.3})),
                    ReversedPaths::no, 400000, 0.02);
}

TEST_CASE("backscattering of a beam on a slab: transport agrees with Monte Carlo in a wide box") {
  const Light beam = gaussian_beam(0.2, {0, 0}, 20);
  check_against_box(1000, 20, {10, 0.3, 0.9},
                    intensity_request({{beam}}, far_views({pi + 0.2, pi + 0.205})),
                    ReversedPaths::yes, 400000, 0.02);
}

TEST_CASE("near sources outside a slab: transport agrees with Monte Carlo in a wide box") {
  constexpr double depth = 20;
  const Light source = point_source({0, -3}), moved = point_source({0.5, -3});
  check_against_box(3000, depth, {10, 0.3, 0.9},
                    full_request({{source, moved}}, far_views({0.1, pi - 0.3})), ReversedPaths::no,
                    400000, 0.03);
}

TEST_CASE("near sensors outside a slab: transport agrees with Monte Carlo in a wide box") {
  constexpr double depth = 20;
  const std::vector<View> sensors = {near_sensor({0, depth + 3}), near_sensor({0.2, depth + 3}),
                                     near_sensor({0, -3})};
  check_against_box(2000, depth, {10, 0.3, 0.9}, full_request({0.2, 0.205}, sensors),
                    ReversedPaths::no, 400000, 0.05);
}

}  // namespace flatspeckle::mc::test_near_endpoints
