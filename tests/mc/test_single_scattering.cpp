#include <cmath>

#include <doctest/doctest.h>

#include "mc/paths/endpoint_factors/endpoint_factors.h"
#include "mc/theory/memory_effect.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_single_scattering {

namespace {

using tests::pi;

/// Albedo so small that double scattering, of relative order albedo, is negligible.
constexpr double dark = 1e-6;

/// Returns the distance to the outline along w, for an independent evaluation of C14 with B = 1.
double chord(const Scene& scene, Vec x, Vec w) {
  const double z_end = w.z > 0 ? scene.domain.depth : 0;
  double longest = std::abs(w.z) > 1e-12 ? (z_end - x.z) / w.z : 1e300;
  if (scene.domain.kind == Domain::Kind::box && std::abs(w.x) > 1e-12) {
    const double x_end = std::copysign(scene.domain.width / 2, w.x);
    longest = std::min(longest, (x_end - x.x) / w.x);
  }
  return longest;
}

Complex light_factor(const Scene& scene, double light, Vec x) {
  const Vec w{std::sin(light), std::cos(light)};
  return std::exp(Complex(-scene.medium.mu_t * chord(scene, x, -w) / 2, scene.k * dot(w, x)));
}

Complex view_factor(const Scene& scene, const View& view, Vec x) {
  if (view.near) {
    const Vec to_sensor = view.point - x;
    const double r = length(to_sensor);
    const double inside = std::min(r, chord(scene, x, 1 / r * to_sensor));
    // exp(ikr)/sqrt(r) is the far form of sqrt(pi k/2) e^{i pi/4} H0(kr)
    const Complex hankel(::j0(scene.k * r), ::y0(scene.k * r));
    return std::sqrt(pi * scene.k / 2) * std::polar(1.0, pi / 4) * hankel *
           std::exp(-scene.medium.mu_t * inside / 2);
  }
  const Vec w{std::sin(view.angle), std::cos(view.angle)};
  return std::exp(Complex(-scene.medium.mu_t * chord(scene, x, w) / 2, -scene.k * dot(w, x)));
}

double phase_amplitude(const Scene& scene, double light, const View& view, Vec x) {
  const double out = view.near ? angle_of(view.point - x) : view.angle;
  const double g = scene.scatterer.g;
  return std::sqrt((1 - g * g) / (2 * pi * (1 + g * g - 2 * g * std::cos(out - light))));
}

/// Returns mu_s int dx [e A e]_a conj[e A e]_b by the midpoint rule; for a slab per unit length, at
/// x = 0.
Complex single_scattering(const Scene& scene, Channel a, Channel b, int nx, int nz) {
  const auto& request = scene.request;
  const bool box = scene.domain.kind == Domain::Kind::box;
  const double width = box ? scene.domain.width : 1, depth = scene.domain.depth;
  const auto field = [&](Channel c, Vec x) {
    const View& view = request.views[c.view];
    const double light = request.lights[c.light].angle;
    return light_factor(scene, light, x) * phase_amplitude(scene, light, view, x) *
           view_factor(scene, view, x);
  };
  Complex sum = 0;
  for (int i = 0; i < (box ? nx : 1); ++i) {
    for (int j = 0; j < nz; ++j) {
      const Vec x{box ? ((i + 0.5) / nx - 0.5) * width : 0, (j + 0.5) * depth / nz};
      sum += field(a, x) * std::conj(field(b, x));
    }
  }
  return scene.medium.mu_s * width * depth / (box ? nx * nz : nz) * sum;
}

void check_entries(const Scene& scene, std::uint64_t paths, std::uint64_t seed, int nx, int nz) {
  const Estimate found = tests::run(scene, ReversedPaths::automatic, paths, seed).entries();
  for (std::size_t e = 0; e < scene.request.entries.size(); ++e) {
    const auto [a, b] = scene.request.entries[e];
    const Complex expected =
        single_scattering(scene, scene.request.channels[a], scene.request.channels[b], nx, nz);
    CAPTURE(e);
    CAPTURE(scene.scatterer.g);
    CHECK_WITHIN_4_SIGMA(found.value[e] / dark, found.error[e] / dark, expected / dark,
                         2e-3 * std::abs(expected) / dark);
    CHECK(found.error[e] < 0.03 * std::abs(found.value[0]));
  }
}

}  // namespace

TEST_CASE("single scattering of a box: agrees with C14, B = 1, for views from all sides") {
  const auto intensities =
      intensity_request({0, 0.7, -2.5}, tests::far_views({0, 1.0, pi / 2, 2.2, pi, -0.4, -1.9}));
  const auto pairs = pairs_request(
      {{0, 0.3, 0.02, 0.31}, {0.5, -0.5, 0.4, -0.55}, {0, 3.0, 0.03, 3.05}, {1, 2, 1, 2}});
  for (const double g : {0.0, 0.8}) {
    check_entries(tests::hg_box(6, 4, {2, g, dark}, intensities), 100000, 1, 120, 80);
    check_entries(tests::hg_box(6, 4, {2, g, dark}, pairs), 100000, 2, 240, 160);
  }
}

TEST_CASE("single scattering of a slab: agrees with C14, B = 1, per unit length") {
  const auto intensities =
      intensity_request({0, 0.7, -1.4}, tests::far_views({0, 1.0, 1.5, 2.2, pi, -1.9, -0.3}));
  const auto tilted = memory_effect_request(2 * pi, 0.4, {-0.3, pi - 0.2}, {0.02, -0.05});
  for (const double g : {0.0, 0.8}) {
    check_entries(tests::hg_slab(4, {2, g, dark}, intensities), 100000, 3, 1, 2000);
    check_entries(tests::hg_slab(4, {2, g, dark}, tilted), 100000, 4, 1, 2000);
  }
}

TEST_CASE("single scattering at near sensors: agrees with C14 with the Hankel function") {
  CovarianceRequest request = full_request(
      {0, 0.6}, {near_sensor({0.5, 4.6}), near_sensor({-4, 2}), near_sensor({1, -30})});
  for (const double g : {0.0, 0.5})
    check_entries(tests::hg_box(6, 4, {2, g, dark}, request), 200000, 5, 240, 160);
}

TEST_CASE("memory effect of a thin slab: agrees with C21, unlimited in the forward direction") {
  const double k = 2 * pi, depth = 10;
  const std::vector<double> tilts = {0.01, 0.05, -0.08, 0.2};
  for (const double view : {0.6, -0.3, pi - 0.4, 0.1}) {
    const double light = 0.1;
    const auto request = memory_effect_request(k, light, {view}, tilts);
    const Scene scene = tests::hg_slab(depth, {1000 * depth, 0, dark}, request);
    const auto result = tests::run(scene, ReversedPaths::automatic, 64000, 6);
    const auto effect = memory_effect(request, result.sums, result.job.covariance);
    for (std::size_t t = 0; t < tilts.size(); ++t) {
      // exact z components; to first order in the tilt q L (tan v - tan i)/2
      const double light2 = light + tilts[t];
      const double view2 = request.views[request.channels[request.entries[t].b].view].angle;
      const double phase =
          k * depth / 2 * (std::cos(light) - std::cos(light2) - std::cos(view) + std::cos(view2));
      const double expected = phase == 0 ? 1 : std::abs(std::sin(phase) / phase);
      CAPTURE(view);
      CAPTURE(tilts[t]);
      CHECK_WITHIN_4_SIGMA(effect.correlation[t], effect.correlation_error[t], expected, 2e-3);
      if (view == light) CHECK(effect.correlation[t] > 0.9999);
      if (std::abs(tilts[t]) < 0.02) {
        const double c21 = request.tilt_q[t] * depth / 2 * (std::tan(view) - std::tan(light));
        CHECK(std::abs(phase) == doctest::Approx(std::abs(c21)).epsilon(0.05));
      }
    }
  }
}

TEST_CASE("outgoing wave: H0 nearby, its far form beyond, continuous to O(1/8kr)") {
  const double k = 3;
  for (const double kr : {0.01, 1.0, 9.99}) {
    const Complex hankel(std::cyl_bessel_j(0, kr), std::cyl_neumann(0, kr));
    const Complex expected = std::sqrt(pi * k / 2) * std::polar(1.0, pi / 4) * hankel;
    CHECK(std::abs(outgoing_wave(k, kr / k) - expected) < 1e-12 * std::abs(expected));
  }
  const Complex before = outgoing_wave(k, (10 - 1e-9) / k),
                after = outgoing_wave(k, (10 + 1e-9) / k);
  CHECK(std::abs(before - after) / std::abs(after) < 1.1 / 80);
  CHECK(std::norm(before) == doctest::Approx(std::norm(after)).epsilon(1e-3));
  CHECK(std::abs(after - std::polar(std::sqrt(k / 10), 10.0)) < 1e-8);
}

}  // namespace flatspeckle::mc::test_single_scattering
