// Limits and symmetries of near sources, beams and sensors.
#include <cmath>

#include <doctest/doctest.h>

#include "mc/theory/memory_effect.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_near_field {

namespace {

using tests::is_night;
using tests::pi;

constexpr double k = 2 * pi;

Estimate estimate(const CovarianceRequest& request, std::uint64_t paths, std::uint64_t seed,
                  const tests::HgBulk& bulk = {4, 0.5}, double width = 20, double depth = 10) {
  return tests::run(tests::hg_box(width, depth, bulk, request), ReversedPaths::automatic, paths,
                    seed)
      .entries();
}

/// Compares found x scale with expected, including both errors.
void check_4_sigma(const Estimate& found, double scale, const Estimate& expected) {
  REQUIRE(found.value.size() == expected.value.size());
  for (std::size_t e = 0; e < found.value.size(); ++e) {
    CAPTURE(e);
    CHECK(std::abs(expected.value[e]) > 10 * expected.error[e]);
    CHECK_WITHIN_4_SIGMA(scale * found.value[e],
                         std::hypot(scale * found.error[e], expected.error[e]), expected.value[e],
                         0.0);
  }
}

}  // namespace

TEST_CASE("reciprocity: near source and far view equal plane wave and near sensor") {
  // outside and inside, in close pairs, so that off-diagonal entries are not small
  const std::vector<Vec> points = {{1, -4}, {1.2, -4}, {0, 3}, {0.2, 3}};
  const std::vector<double> views = {0.3, pi - 0.4};
  const auto both = [&](bool forward) {
    CovarianceRequest request;
    request.kind = CovarianceRequest::Kind::pairs;
    for (Vec point : points) {
      if (forward)
        request.lights.push_back(point_source(point));
      else
        request.views.push_back(near_sensor(point));
    }
    for (double view : views) {
      if (forward)
        request.views.push_back(far_view(view));
      else
        request.lights.push_back(plane_wave(view + pi));
    }
    for (std::uint32_t v = 0; v < 2; ++v)
      for (std::uint32_t s = 0; s < 4; ++s)
        request.channels.push_back(forward ? Channel{s, v} : Channel{v, s});
    for (std::uint32_t c = 0; c < 8; ++c) request.entries.push_back({c, c});
    for (std::uint32_t c = 0; c < 8; c += 2) request.entries.push_back({c, c + 1});
    return request;
  };
  const auto from_sources = estimate(both(true), 200000, 1);
  check_4_sigma(from_sources, 8 * pi * k, estimate(both(false), 200000, 2));
}

TEST_CASE("distant point source: equals a plane wave") {
  const auto views = tests::far_views({0.2, 1.3, pi - 0.2});
  constexpr double r = 1e6;
  const std::vector<double> angles = {0, 0.6, 2.8};
  Lights sources;
  for (double angle : angles) sources.push_back(point_source(-r * direction(angle)));
  check_4_sigma(estimate(intensity_request(sources, views), 150000, 3), 8 * pi * k * r,
                estimate(intensity_request(angles, views), 150000, 4));
}

TEST_CASE("wide beam: equals a plane wave") {
  const auto views = tests::far_views({0.2, 1.3, pi - 0.2});
  const std::vector<double> angles = {0, 0.6, 2.8};
  Lights beams;
  for (double angle : angles) beams.push_back(gaussian_beam(angle, {0, 0}, 3000));
  check_4_sigma(estimate(intensity_request(beams, views), 150000, 5), 1,
                estimate(intensity_request(angles, views), 150000, 6));
  const auto pairs = full_request({0, 0.01}, tests::far_views({0.3, 0.31}));
  auto wide = pairs;
  wide.lights = {gaussian_beam(0, {0, 0}, 3000), gaussian_beam(0.01, {0, 0}, 3000)};
  check_4_sigma(estimate(wide, 150000, 7), 1, estimate(pairs, 150000, 8));
}

TEST_CASE("wide box: intensities in the middle are independent of x") {
  const std::vector<View> sensors = {near_sensor({0.5, 6}), near_sensor({0, 2})};
  for (const Light& light : {gaussian_beam(0.2, {-2, 1}, 2), point_source({-0.4, 1.5})}) {
    const auto request = translation_request(light, sensors, {0, 3, -5});
    const auto found = estimate(request, 200000, 9, {2, 0.3}, 80, 4);
    for (std::size_t v = 0; v < 2; ++v) {
      const auto still = request.reference_intensity(v);
      CHECK(found.value[request.tilted_entry(0, v)] == found.value[still]);
      for (std::size_t s = 1; s < 3; ++s) {
        const auto moved = request.tilted_intensity(s, v);
        CHECK_WITHIN_4_SIGMA(found.value[moved], std::hypot(found.error[moved], found.error[still]),
                             found.value[still], 0.0);
        CHECK(found.error[moved] < 0.1 * std::abs(found.value[moved]));
      }
    }
  }
}

TEST_CASE("beam moved over a thin medium: correlation agrees with the overlap of the fields") {
  const std::vector<double> shifts = {0, 0.25, 0.5, 1, 1.5, 2, 3, 4};
  const auto request =
      translation_request(gaussian_beam(0, {0, 0}, 2), tests::far_views({0.2}), shifts);
  const auto run =
      tests::run(tests::hg_box(40, 4, {2000, 0.3}, request), ReversedPaths::automatic, 100000, 10);
  const auto effect = memory_effect(request, run.sums, run.job.covariance);
  constexpr double twice = 0.01;  // share of double scattering: half the width in mean free paths
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    CAPTURE(shifts[i]);
    const double overlap = std::exp(-shifts[i] * shifts[i] / 8);
    CHECK(std::abs(effect.correlation[i] - overlap) < 4 * effect.correlation_error[i] + twice);
    CHECK(effect.correlation_error[i] < 0.01 * tests::effort().errors);
  }
  CHECK(effect.range.range.censored == Range::Censoring::none);
  const double half = 2 * std::sqrt(std::numbers::ln2),
               steepness = half / 4;  // derivative of C_I there
  CHECK(std::abs(effect.range.range.value - half) < 4 * effect.range.error + 2 * twice / steepness);
  CHECK(effect.range.error < 0.02 * tests::effort().errors);
}

TEST_CASE("error bars of sensors inside the medium: agree with the spread over runs") {
  // Compares the scatter of independent small runs with their reported errors.
  const auto request = intensity_request(Lights{0.0}, {near_sensor({1, 3}), near_sensor({0, 6})});
  const Scene scene = tests::hg_box(20, 10, {4, 0}, request);
  const int runs = is_night ? 800 : 400, paths = is_night ? 2000 : 800;
  double sum[2] = {}, squares[2] = {}, reported[2] = {};
  for (int i = 0; i < runs; ++i) {
    const auto found =
        tests::run(scene, ReversedPaths::automatic, paths, 1000 + i, paths / 20).entries();
    for (std::size_t v = 0; v < 2; ++v) {
      const double value = found.value[v].real();
      sum[v] += value;
      squares[v] += value * value;
      reported[v] += found.error[v] * found.error[v];
    }
  }
  for (std::size_t v = 0; v < 2; ++v) {
    CAPTURE(v);
    const double variance = (squares[v] - sum[v] * sum[v] / runs) / (runs - 1);
    CHECK(std::abs(variance / (reported[v] / runs) - 1) < 4 * std::sqrt(2.0 / runs));
  }
}

}  // namespace flatspeckle::mc::test_near_field
