#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/discrete_ordinates.h"
#include "bench/oracles/slab_theory.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_discrete_ordinates {

namespace {

using oracles::henyey_greenstein;
using oracles::SlabTransport;
using tests::pi;

constexpr double oblique = pi / 3;

/// Returns reflectance, transmittance and three intensities of a slab for light from two angles.
std::vector<double> slab_values(double optical_depth, double albedo, double g, int nodes) {
  const SlabTransport slab({optical_depth, albedo, henyey_greenstein(g)},
                           {0, oblique, 0.5, 1.4, pi - 0.2}, nodes);
  std::vector<double> found;
  for (const double light : {0.0, oblique}) {
    found.push_back(slab.reflectance(light));
    found.push_back(slab.transmittance(light));
    for (const double view : {0.5, -1.4, pi - 0.2})
      found.push_back(slab.covariance_without_reversed(light, view));
  }
  return found;
}

void check_convergence(double g, int nodes, double tolerance) {
  for (const double optical_depth : {0.1, 1.0, 10.0, 100.0}) {
    for (const double albedo : {1.0, 0.9}) {
      if (!tests::is_night && (albedo == 1) != (optical_depth < 0.5 || optical_depth > 50))
        continue;
      CAPTURE(g);
      CAPTURE(optical_depth);
      CAPTURE(albedo);
      const auto coarse = slab_values(optical_depth, albedo, g, nodes);
      const auto fine = slab_values(optical_depth, albedo, g, 3 * nodes / 2);
      for (std::size_t i = 0; i < fine.size(); ++i)
        CHECK(coarse[i] == doctest::Approx(fine[i]).epsilon(tolerance));
    }
  }
}

}  // namespace

TEST_CASE("discrete ordinates: converge with the number of nodes") {
  check_convergence(0, 24, 1e-7);
  check_convergence(0.5, 24, 1e-6);
  check_convergence(-0.5, 24, 1e-6);
  check_convergence(0.9, 80, 1e-5);
}

TEST_CASE("discrete ordinates: conserve power without absorption") {
  for (const double g : {0.0, 0.9, -0.5}) {
    for (const double optical_depth : {0.01, 1.0, 100.0}) {
      for (const double light : {0.0, oblique, 1.55}) {
        const SlabTransport slab({optical_depth, 1, henyey_greenstein(g)}, {light}, 40);
        CHECK(slab.reflectance(light) + slab.transmittance(light) +
                  slab.direct_transmittance(light) ==
              doctest::Approx(1).epsilon(1e-8));
      }
    }
  }
}

TEST_CASE("discrete ordinates: agree with the integral equation of isotropic scattering") {
  for (const double albedo : {1.0, 0.8}) {
    for (const double optical_depth : {0.3, 5.0}) {
      const std::vector<double> views = {0, 0.5, -1.3, pi - 0.4, pi + 1.2};
      for (const double light : {0.0, 0.9}) {
        std::vector<double> angles = views;
        angles.push_back(light);
        const oracles::IsotropicSlab integral(2 * pi, 10, optical_depth / 10, albedo);
        const SlabTransport slab({optical_depth, albedo, henyey_greenstein(0)}, angles, 40);
        for (const double view : views)
          CHECK(slab.covariance_without_reversed(light, view) ==
                doctest::Approx(integral.without_reversed({light, view}, {light, view}).real())
                    .epsilon(2e-4));  // discretisation of the integral equation
      }
    }
  }
}

TEST_CASE("discrete ordinates: a thin slab agrees with single scattering") {
  const double optical_depth = 1e-5, g = 0.7, light = 0.4;
  const std::vector<double> views = {0.1, -0.4, 1.2, pi - 0.3, pi + 1};
  std::vector<double> angles = views;
  angles.push_back(light);
  const SlabTransport slab({optical_depth, 0.9, henyey_greenstein(g)}, angles, 60);
  for (const double view : views)
    CHECK(slab.covariance_without_reversed(light, view) ==
          doctest::Approx(0.9 * optical_depth * henyey_greenstein(g)(view - light)).epsilon(1e-4));
}

TEST_CASE("discrete ordinates: reciprocal") {
  const SlabTransport slab({3, 0.9, henyey_greenstein(0.6)}, {0.3, 1.0}, 40);
  for (const double sign : {1.0, -1.0})
    CHECK(slab.covariance_without_reversed(0.3, sign * 1.0) ==
          doctest::Approx(slab.covariance_without_reversed(1.0, sign * 0.3)).epsilon(1e-10));
}

TEST_CASE("anisotropic slab: intensities agree with discrete ordinates") {
  const std::vector<double> views = {0.1, -0.8, 1.4, pi - 0.3, pi + 1};
  std::uint64_t seed = 70;
  for (const double g : {0.5, 0.9}) {
    for (const double light : {0.0, oblique}) {
      std::vector<double> angles = views;
      angles.push_back(light);
      const double optical_depth = 5, albedo = 0.95;
      const SlabTransport slab({optical_depth, albedo, henyey_greenstein(g)}, angles, 80);
      const auto request = intensity_request({light}, tests::far_views(views));
      const Scene scene = tests::hg_slab(10, {10 / optical_depth, g, albedo}, request);
      const auto found = tests::run(scene, ReversedPaths::no, 150000, ++seed).entries();
      for (std::size_t v = 0; v < views.size(); ++v) {
        CAPTURE(g);
        CAPTURE(light);
        CAPTURE(views[v]);
        const Complex expected = slab.covariance_without_reversed(light, views[v]);
        CHECK_WITHIN_4_SIGMA(found.value[v], found.error[v], expected, 0);
        CHECK(found.error[v] < 0.03 * tests::effort().errors * std::abs(expected));
      }
    }
  }
}

}  // namespace flatspeckle::mc::test_discrete_ordinates
