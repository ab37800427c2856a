#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/quadrature.h"
#include "bench/oracles/slab_theory.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_energy {

namespace {

using tests::pi;

oracles::GaussPanels all_views() {
  oracles::GaussPanels views;
  for (const double start : {-pi, -pi / 2, 0.0, pi / 2}) views.add(start, start + pi / 2, 2);
  return views;
}

/// Returns the intensity of light 0 integrated over all views.
Estimate scattered_power(const std::function<Scene(const CovarianceRequest&)>& scene, double light,
                         std::uint64_t paths, std::uint64_t seed) {
  const auto views = all_views();
  const Scene full = scene(intensity_request({light}, tests::far_views(views.node)));
  return tests::run(full, ReversedPaths::no, paths, seed).weighted_sum(views.weight);
}

/// Returns the power that a box removes from the beam: 1 - exp(-mu_t chord) over the illuminated
/// outline, weighted with the flux through it.
double extinguished_by_box(const Domain& box, double mu_t, double light) {
  const Vec w = direction(light);
  constexpr int points = 4000;
  double power = 0;
  for (int i = 0; i < points; ++i) {
    const double t = (i + 0.5) / points;
    const Vec on_face{(t - 0.5) * box.width, w.z > 0 ? 0 : box.depth};
    const Vec on_side{std::copysign(box.width / 2, -w.x), t * box.depth};
    const auto lost = [&](Vec entry) {
      return -std::expm1(-mu_t * box.distance_to_edge(entry, w));
    };
    power += std::abs(w.z) * box.width / points * lost(on_face);
    power += std::abs(w.x) * box.depth / points * lost(on_side);
  }
  return power;
}

/// Counts of an analog simulation that shares only the random numbers with the estimator: photons,
/// not paths, counted where they leave. Shares of the photons that enter the medium.
struct PhotonCount {
  double unscattered = 0, forward = 0, backward = 0, absorbed = 0;
};

PhotonCount count_photons(const Scene& scene, double light, int photons, std::uint64_t seed) {
  RandomStream random(seed, 80, 0);
  const Domain& domain = scene.domain;
  const bool box = domain.kind == Domain::Kind::box;
  const double g = scene.scatterer.g, flux_face = domain.width * std::cos(light);
  const double flux_side = domain.depth * std::abs(std::sin(light));
  PhotonCount count;
  for (int i = 0; i < photons; ++i) {
    Vec x{0, 0}, w{std::sin(light), std::cos(light)};
    if (box && random.uniform() * (flux_face + flux_side) > flux_face)
      x = {std::copysign(domain.width / 2, -w.x), random.uniform() * domain.depth};
    else if (box)
      x.x = (random.uniform() - 0.5) * domain.width;
    for (bool scattered = false;; scattered = true) {
      x = x + -std::log(random.uniform()) / scene.medium.mu_t * w;
      if (!domain.contains(x)) {
        (scattered ? (w.z > 0 ? count.forward : count.backward) : count.unscattered) +=
            1.0 / photons;
        break;
      }
      if (random.uniform() > scene.medium.albedo) {
        count.absorbed += 1.0 / photons;
        break;
      }
      const double turn =
          2 * std::atan((1 - g) / (1 + g) * std::tan(pi * (random.uniform() - 0.5)));  // C22
      w = {w.x * std::cos(turn) + w.z * std::sin(turn),
           w.z * std::cos(turn) - w.x * std::sin(turn)};
    }
  }
  return count;
}

void check_against_photons(const std::function<Scene(const CovarianceRequest&)>& make, double light,
                           double incident_power, std::uint64_t seed) {
  const auto views = all_views();
  const Scene scene = make(intensity_request({light}, tests::far_views(views.node)));
  const auto result = tests::run(scene, ReversedPaths::no, 30000, seed);
  std::vector<double> forward = views.weight, backward = views.weight;
  for (std::size_t v = 0; v < views.node.size(); ++v)
    (std::cos(views.node[v]) > 0 ? backward : forward)[v] = 0;
  constexpr int photons = 200000;
  const auto count = count_photons(scene, light, photons, seed);
  const auto compare = [&](const std::vector<double>& weights, double share) {
    const auto power = result.weighted_sum(weights);
    const double photon_error = std::sqrt(share * (1 - share) / photons);
    CHECK_WITHIN_4_SIGMA(power.value[0] / incident_power,
                         std::hypot(power.error[0] / incident_power, photon_error), share, 0);
  };
  compare(forward, count.forward);
  compare(backward, count.backward);
}

}  // namespace

TEST_CASE("lossless slab: scattered power equals the extinction of the beam") {
  std::uint64_t seed = 0;
  for (const double light : {0.0, 0.9}) {
    for (const double g : {0.0, 0.9}) {
      for (const double optical_depth : {0.1, 5.0}) {
        const auto power = scattered_power(
            [&](const CovarianceRequest& request) {
              return tests::hg_slab(10, {10 / optical_depth, g}, request);
            },
            light, 30000, ++seed);
        CAPTURE(light);
        CAPTURE(g);
        const double expected = std::cos(light) * -std::expm1(-optical_depth / std::cos(light));
        CHECK_WITHIN_4_SIGMA(power.value[0], power.error[0], expected, 1e-3 * expected);
        CHECK(power.error[0] < 0.02 * expected);
      }
    }
  }
}

TEST_CASE("lossless box: scattered power equals the extinction of the beam from any side") {
  std::uint64_t seed = 20;
  for (const double light : {0.0, 0.6, -pi / 2, 2.4}) {
    for (const double g : {0.0, 0.9}) {
      Domain domain;
      const auto power = scattered_power(
          [&](const CovarianceRequest& request) {
            const Scene scene = tests::hg_box(6, 4, {2, g}, request);
            domain = scene.domain;
            return scene;
          },
          light, 30000, ++seed);
      CAPTURE(light);
      CAPTURE(g);
      const double expected = extinguished_by_box(domain, 0.5, light);
      CHECK_WITHIN_4_SIGMA(power.value[0], power.error[0], expected, 2e-3 * expected);
      CHECK(power.error[0] < 0.02 * expected);
    }
  }
}

TEST_CASE("absorbing slab: scattered power agrees with the integral equation") {
  std::uint64_t seed = 40;
  for (const double light : {0.0, 0.9}) {
    for (const double albedo : {0.99, 0.5}) {
      const oracles::IsotropicSlab theory(2 * pi, 10, 0.5, albedo);
      const auto power = scattered_power(
          [&](const CovarianceRequest& request) {
            return tests::hg_slab(10, {2, 0, albedo}, request);
          },
          light, 30000, ++seed);
      const double expected =
          std::cos(light) * (-std::expm1(-5 / std::cos(light)) - theory.absorbed(light));
      CHECK_WITHIN_4_SIGMA(power.value[0], power.error[0], expected, 1e-3 * expected);
    }
  }
}

TEST_CASE(
    "anisotropic absorbing media: transmitted and reflected power agree with counted photons") {
  const double light = 0.7;
  check_against_photons(
      [](const CovarianceRequest& request) {
        return tests::hg_slab(10, {2, 0.8, 0.9}, request);
      },
      light, std::cos(light), 61);
  check_against_photons(
      [](const CovarianceRequest& request) {
        return tests::hg_box(10, 6, {2, -0.4, 0.8}, request);
      },
      light, 10 * std::cos(light) + 6 * std::sin(light), 62);
  check_against_photons(
      [](const CovarianceRequest& request) {
        return tests::hg_box(10, 6, {1, 0.9, 1}, request);
      },
      0, 10, 63);
}

}  // namespace flatspeckle::mc::test_energy
