#include <cmath>

#include <doctest/doctest.h>

#include "mc/theory/diffusion.h"
#include "mc/theory/memory_effect.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_tilt_shift {

namespace {

using tests::pi;

constexpr double k = 2 * pi, light = 0.1;
const std::vector<double> views = {0.3, -0.2}, tilts = {0, 0.01, -0.03};

Scene box(const CovarianceRequest& request) {
  return tests::hg_box(30, 8, {3, 0.4}, request);
}

/// Returns the shifts that match the tilts, in the same order.
std::vector<double> matched_shifts() {
  std::vector<double> shifts;
  for (double tilt : tilts)
    shifts.push_back(tilt == 0 ? 0 : k * (std::sin(light + tilt) - std::sin(light)));
  return shifts;
}

CovarianceRequest map_request(std::vector<double> shifts) {
  return tilt_shift_request(k, plane_wave(light), tests::far_views(views), tilts, shifts);
}

}  // namespace

TEST_CASE("tilt-shift map: equals the memory effect at matched shifts") {
  const auto request = map_request(matched_shifts());
  const auto found = tests::run(box(request), ReversedPaths::automatic, 60000, 1).entries();
  const auto effect = memory_effect_request(k, light, views, tilts);
  const auto expected = tests::run(box(effect), ReversedPaths::automatic, 60000, 2).entries();
  for (std::size_t t = 0; t < 3; ++t) {
    for (std::size_t v = 0; v < 2; ++v) {
      const auto on_map = request.tilted_entry(3 * t + t, v),
                 matched = request.tilted_entry(9 + t, v);
      CHECK(std::abs(found.value[on_map] - found.value[matched]) <
            1e-12 * std::abs(found.value[matched]));
      const auto e = effect.tilted_entry(t, v);
      CHECK_WITHIN_4_SIGMA(found.value[matched],
                           std::hypot(found.error[matched], expected.error[e]), expected.value[e],
                           0.0);
    }
  }
}

TEST_CASE("tilt-shift map of a wide box: almost 0 at unmatched shifts") {
  const auto request = map_request({0, 1.5});
  const auto run = tests::run(box(request), ReversedPaths::automatic, 60000, 3);
  const auto map =
      correlations(request, run.sums, run.job.covariance, view_groups(request).front());
  REQUIRE(map.moves.value.size() > 7);
  CHECK(map.moves.value[0].real() == doctest::Approx(1).epsilon(1e-12));
  CHECK(map.moves.value[1].real() < 0.1);  // sinc(1.5 x 30 / 2) and noise
  // matched views
  CHECK(map.moves.value[6].real() == doctest::Approx(1).epsilon(1e-12));
  CHECK(map.moves.value[7].real() > 0.9);
  CHECK(map.moves.error[7] > 0);
  CHECK(map.moves.error[7] < 0.02);
}

TEST_CASE("tilt-shift map: half-widths along its axes agree with the width of the box") {
  // Along either axis alone the box's width is the limit: sinc(q W / 2) if evenly illuminated.
  std::vector<double> steps, small_tilts;
  for (int i = 0; i <= 8; ++i) {
    steps.push_back(0.02 * i);
    small_tilts.push_back(std::asin(std::sin(light) + 0.02 * i / k) - light);
  }
  small_tilts[0] = 0;
  const auto request =
      tilt_shift_request(k, plane_wave(light), tests::far_views({0.3}), small_tilts, steps);
  const auto run =
      tests::run(tests::hg_box(60, 4, {4, 0.4}, request), ReversedPaths::automatic, 60000, 4);
  const auto map =
      correlations(request, run.sums, run.job.covariance, view_groups(request).front());
  const double expected = 2 * 1.391557 / 60;
  CHECK(map.ranges[1].range.value == doctest::Approx(expected).epsilon(0.1));
  CHECK(map.ranges[0].range.value == doctest::Approx(expected).epsilon(0.1));
  CHECK(map.ranges[1].error < 0.005);
  CHECK(map.ranges[2].range.censored == Range::Censoring::above_value);
}

TEST_CASE("tilt-shift map: near sensors are shifted along x") {
  const std::vector<View> sensors = {near_sensor({0, 9}), near_sensor({2, 4})};
  const auto request = tilt_shift_request(k, plane_wave(light), sensors, {0, 0.004}, {0, 0.4});
  CHECK(request.moves == 4);
  const auto [a, b] = request.entries[request.tilted_entry(3, 1)];
  CHECK(request.views[request.channels[a].view].point == Vec{2, 4});
  CHECK(request.views[request.channels[b].view].point == Vec{2.4, 4});
  CHECK(request.lights[request.channels[b].light].angle == doctest::Approx(light + 0.004));
  // A shift of 0.4 wavelengths decorrelates light from all directions; a tilt that changes the
  // phase by 0.08 over a mean free path does not.
  const auto run = tests::run(box(request), ReversedPaths::automatic, 40000, 5);
  const auto map =
      correlations(request, run.sums, run.job.covariance, view_groups(request).front());
  CHECK(map.moves.value.size() == 4);  // none matched
  CHECK(map.moves.value[1].real() < 0.9);
  CHECK(map.moves.value[2].real() > 0.9);
}

TEST_CASE("single-scattering correlation: agrees with C21, its square averaged over views") {
  const double q = 0.7, depth = 5;
  const auto sinc = [](double a) { return std::sin(a) / a; };
  const double a = q * depth * (std::tan(0.5) - std::tan(0.1)) / 2,
               b = q * depth * (std::tan(-0.3) - std::tan(0.1)) / 2;
  CHECK(single_scattering_correlation(plane_wave(0.1), {far_view(0.5)}, depth, q) ==
        doctest::Approx(std::abs(sinc(a))).epsilon(1e-12));
  CHECK(single_scattering_correlation(plane_wave(0.1), {far_view(0.5), far_view(-0.3)}, depth, q) ==
        doctest::Approx(std::hypot(sinc(a), sinc(b)) / std::sqrt(2)));
  CHECK(single_scattering_correlation(plane_wave(0.1), {far_view(0.1)}, depth, q) == 1);
  const double c =
      q * depth * std::tan(0.4) * std::sin(1) / 2;  // tilt out of the plane of incidence
  CHECK(single_scattering_correlation(plane_wave(0.5), {far_view(0.4, 1)}, depth, q, pi / 2) ==
        doctest::Approx(std::abs(sinc(c))));
}

}  // namespace flatspeckle::mc::test_tilt_shift
