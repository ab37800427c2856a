#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/random.h"
#include "grin/media/scattering/mie_phase.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/paths/estimators/gradient.h"
#include "mc/slab/adding/space.h"
#include "tests/mc/space/scenes_in_space.h"

namespace flatspeckle::mc::test_space_walks {

namespace {

using tests::by_transport;
using tests::check_agreement;
using tests::hg_in_space;
using tests::pi;
using tests::tilted_pairs;

constexpr double depth = 200;
const std::vector<double> momenta = {0, 1 / depth, -3 / depth};

/// Returns pairs of directions at random azimuths, and their intensities. The transverse momenta of
/// lights and views change by the same random vector of at most 3 / depth.
CovarianceRequest random_pairs(int count) {
  RandomStream random(7, 0, 0);
  const auto ends = [](double x, double y, double side) {
    return std::array{std::atan2(std::hypot(x, y), side * std::sqrt(1 - x * x - y * y)),
                      std::atan2(y, x)};
  };
  std::vector<AnglePair> pairs;
  for (int i = 0; i < count; ++i) {
    const auto uniform = [&](double most) { return most * (2 * random.uniform() - 1); };
    const double lx = uniform(0.5), ly = uniform(0.5), vx = uniform(0.5), vy = uniform(0.5),
                 side = i % 2 == 0 ? 1 : -1, qx = uniform(3 / depth) / (2 * pi),
                 qy = uniform(3 / depth) / (2 * pi);
    const auto l1 = ends(lx, ly, 1), l2 = ends(lx + qx, ly + qy, 1), v1 = ends(vx, vy, side),
               v2 = ends(vx + qx, vy + qy, side);
    pairs.push_back({l1[0], v1[0], l1[0], v1[0], {l1[1], v1[1], l1[1], v1[1]}});
    pairs.push_back({l1[0], v1[0], l2[0], v2[0], {l1[1], v1[1], l2[1], v2[1]}});
  }
  return pairs_request(pairs);
}

}  // namespace

TEST_CASE("3D slabs: Monte Carlo agrees with transport") {
  for (const auto& [g, optical_depth, albedo] :
       {std::array{0.0, 0.1, 0.7}, {-0.5, 2.0, 1.0}, {0.6, 8.0, 0.9}})
    for (const double view : {-0.3, 2.5})
      check_agreement(tests::in_space(hg_in_space(depth, optical_depth, g, albedo),
                                      tilted_pairs(0.4, view, momenta)),
                      false, 60000, 0.05);
  check_agreement(tests::in_space(hg_in_space(depth, 5, 0.9, 1), tilted_pairs(0.05, 0, momenta)),
                  false, 60000, 0.05);
}

TEST_CASE("3D slabs: pairs off the plane of incidence agree with transport") {
  for (const auto& [g, optical_depth] : {std::pair{0.0, 1.0}, {0.7, 4.0}}) {
    const Scene scene =
        tests::in_space(hg_in_space(depth, optical_depth, g, 0.95), random_pairs(10));
    const auto found =
        tests::run(scene, ReversedPaths::no, tests::is_night ? 20000000 : 100000, 3).entries();
    const auto expected = by_transport(scene, false, tests::is_night ? 1e-5 : 1e-4).value;
    for (std::size_t e = 0; e < expected.size(); ++e) {
      CAPTURE(e);
      CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected[e], 0);
      CHECK(found.error[e] < (tests::is_night ? 0.003 : 0.05) * std::abs(expected[e - e % 2]));
    }
  }
}

TEST_CASE("3D layers: Monte Carlo agrees with transport") {
  const CovarianceRequest request = tilted_pairs(0.3, 0.2, {0, 2.0 / 60});
  const SceneSpec values;
  check_agreement(
      mc::in_space(
          tests::layered({{20, 2, 0.8, 0.99}, {30, 0.5, 0, 0.6}, {10, 1, -0.3, 1}}, request),
          values),
      false, 60000, 0.05);
}

TEST_CASE("3D slabs: Monte Carlo with reversed paths agrees with transport") {
  for (const double off : {0.0, 0.002, 0.02})
    check_agreement(tests::in_space(hg_in_space(depth, 4, 0.5, 0.98),
                                    tilted_pairs(0.1, pi + 0.1 + off, momenta)),
                    true, 40000, 0.05);
}

TEST_CASE("3D slabs: Monte Carlo at a wide tilt agrees with transport") {
  check_agreement(tests::in_space(hg_in_space(20, 1, 0.8, 1), tilted_pairs(0, 0.5, {0, 0.5, -1.5})),
                  false, 100000, 0.05);
}

TEST_CASE("3D slabs of two-term Henyey-Greenstein scatterers: Monte Carlo agrees with transport") {
  SceneSpec spec = hg_in_space(depth, 3, 0, 0.95);
  spec.g = std::nullopt;
  spec.scatterer = "two_term_hg";
  auto& terms = std::get<TwoTermHg>(spec.bulk);
  terms.g = 0.8;
  terms.g_back = -0.4;
  terms.forward_share = 0.7;
  check_agreement(tests::in_space(spec, tilted_pairs(0.2, 0, momenta)), false, 40000, 0.05);
}

TEST_CASE("Rayleigh phase function: normalised in 2D, moments and Monte Carlo agree in 3D") {
  SceneSpec spec = hg_in_space(depth, 3, 0, 0.9);
  spec.g = std::nullopt;
  spec.scatterer = "rayleigh";
  const auto plane = make_scene(spec).medium.phase.density;
  double whole = 0;
  for (int i = 0; i < 8; ++i) whole += 2 * pi / 8 * plane(pi * (i + 0.5) / 8);
  CHECK(whole == doctest::Approx(1).epsilon(1e-12));
  CHECK(plane(pi / 2) == doctest::Approx(plane(0) / 2).epsilon(1e-12));
  const Scene scene = tests::in_space(spec, tilted_pairs(0.2, 0, momenta));
  check_agreement(scene, false, 40000, 0.05);
  const auto moments = SpaceGeometry::law(scene).moments();  // 3/4 (1 + c^2) = 1 + P_2 / 2
  REQUIRE(moments.size() == 3);
  CHECK(moments[1] == doctest::Approx(0).epsilon(1e-12));
  CHECK(moments[2] == doctest::Approx(0.1).epsilon(1e-12));
}

TEST_CASE("3D slabs of spheres: Monte Carlo agrees with transport, bad parameters are rejected") {
  SceneSpec spec = hg_in_space(depth, 4, 0, 1);
  spec.g = spec.albedo = std::nullopt;
  spec.scatterer = "mie";
  CHECK_THROWS_WITH_AS(make_scene(spec), doctest::Contains("radius"), InputError);
  spec.radius = 1;
  CHECK_THROWS_WITH_AS(make_scene(spec), doctest::Contains("dimension = 3"), InputError);
  spec.dimension = 3;
  for (const auto& [radius, index] : {std::pair{0.3, "1.2"}, {1.0, "1.2+0.01i"}, {0.5, "0.8"}}) {
    spec.radius = radius;
    spec.index = index;
    CAPTURE(*spec.index);
    const Scene scene = tests::in_space(spec, tilted_pairs(0.2, 0, momenta));
    const grin::MieSphere sphere(2 * pi * radius, scene.scatterer.index);
    CHECK(scene.medium.g == sphere.mean_cosine());
    CHECK(scene.medium.albedo ==
          doctest::Approx(sphere.scattering() / sphere.extinction()).epsilon(1e-12));
    CHECK(scene.medium.mu_s == scene.medium.albedo * scene.medium.mu_t);
    const SpaceLaw law = SpaceGeometry::law(scene);
    CHECK(law.moments()[1] == doctest::Approx(sphere.mean_cosine()).epsilon(1e-12));
    CHECK(static_cast<int>(law.moments().size()) <= 2 * sphere.order() + 1);
    check_agreement(scene, false, 60000, 0.05);
  }
  spec.radius = 100;
  CHECK_THROWS_WITH_AS(tests::in_space(spec, tilted_pairs(0.2, 0, momenta)),
                       doctest::Contains("1e-6 to 500"), InputError);
  spec.radius = 1;
  spec.index = std::string("1");
  CHECK_THROWS_WITH_AS(tests::in_space(spec, tilted_pairs(0.2, 0, momenta)),
                       doctest::Contains("do not scatter"), InputError);
}

TEST_CASE("3D slabs: temporal correlation by Monte Carlo agrees with transport") {
  const std::vector<double> delays = {0.003, 0.03, 0.3};
  for (const double view : {0.3, pi + 0.1}) {
    const bool reversed = view > 1;
    const auto scene = tests::in_space(hg_in_space(depth, 4, 0.6, 0.95),
                                       intensity_request({0.1}, {far_view(view)}));
    const auto plan = make_plan(scene, reversed ? ReversedPaths::yes : ReversedPaths::no);
    const auto job = delay_job(scene, plan, delays, 5);
    const auto walked = jackknife(tests::summed(job.field.batches, 60000), job.all);
    for (std::size_t t = 0; t < delays.size(); ++t) {
      const Complex expected =
          slab_covariance(scene, reversed, {1e-3}, {.delay = delays[t]}).value[0];
      CHECK_WITHIN_4_SIGMA(walked.value[1 + t], walked.error[1 + t], expected, 0);
      CHECK(walked.error[1 + t] < 0.05 * std::abs(expected));
    }
  }
}

TEST_CASE("3D slabs: derivatives by Monte Carlo agree with differences of transport") {
  const auto at = [](double mu_t, double g, double albedo) {
    return tests::in_space(hg_in_space(depth, mu_t * depth, g, albedo),
                           intensity_request({0.1}, {far_view(-0.3)}));
  };
  constexpr double mu_t = 0.02, g = 0.6, albedo = 0.95, step = 1e-3;
  const auto derivative = [&](double by_mu_t, double by_g, double by_albedo) {
    const auto moved = [&](double by) {
      return by_transport(at(mu_t + by * by_mu_t, g + by * by_g, albedo + by * by_albedo), false,
                          1e-6)
          .value[0];
    };
    return (moved(step) - moved(-step)) / (2 * step);
  };
  const std::vector<Complex> expected = {derivative(mu_t, 0, 0) / mu_t, derivative(0, 1, 0),
                                         derivative(0, 0, 1)};
  const Scene scene = at(mu_t, g, albedo);
  const auto job = gradient_job(scene, gradient_plan(scene, ReversedPaths::no), 3);
  const auto walked = jackknife(tests::summed(job.field.batches, 100000), job.gradient);
  for (std::size_t p = 0; p < expected.size(); ++p) {
    CHECK_WITHIN_4_SIGMA(walked.value[p], walked.error[p], expected[p], 0);
    CHECK(walked.error[p] < 0.1 * std::abs(expected[p]));
  }
}

}  // namespace flatspeckle::mc::test_space_walks
