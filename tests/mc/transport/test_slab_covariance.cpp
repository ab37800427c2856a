#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "bench/oracles/slab_theory.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/slab/slab_covariance.h"
#include "mc/slab/slab_jobs.h"
#include "mc/theory/diffusion.h"
#include "mc/theory/memory_effect.h"
#include "tests/mc/transport/sixth_order.h"
#include "tests/mc/transport/slabs.h"
#include "tests/oracles/pair_transport.h"

namespace flatspeckle::mc::test_slab_covariance {

namespace {

using tests::deflected;
using tests::hg_slab;
using tests::is_night;
using tests::pi;
using tests::wavenumber;

/// Returns, for depth 2000 and light along the normal, the intensity, C_E for q L = 2 and the
/// reflected ladder at pi - 0.2.
std::vector<double> intensity_correlation_ladder(double optical_depth, double g, double albedo,
                                                 const Refinement& refinement) {
  constexpr double depth = 2000;
  const tests::HgBulk bulk{depth / optical_depth, g, albedo};
  const auto request = memory_effect_request(wavenumber, 0, {0}, {deflected(0, 2 / depth)});
  const auto tilted = slab_covariance(hg_slab(depth, bulk, request), false, refinement);
  const auto back = slab_covariance(
      hg_slab(depth, bulk, intensity_request({0.0}, {far_view(pi - 0.2)})), false, refinement);
  return {tilted.value[request.reference_intensity(0)].real(),
          field_correlation(request, tilted.value)[0].real(), back.value[0].real()};
}

/// Returns q L at which C_I falls to 1/2 for light along the normal.
double half_width(double optical_depth, double g, double albedo) {
  constexpr double depth = 2000;
  std::vector<double> tilts;
  for (int i = 0; i <= 48; ++i) tilts.push_back(deflected(0, 0.0625 * i / depth));
  const auto request = memory_effect_request(wavenumber, 0, {0}, tilts);
  const auto found =
      slab_covariance(hg_slab(depth, {depth / optical_depth, g, albedo}, request), false, {1e-7});
  return depth * memory_effect_range(request.tilt_q, field_correlation(request, found.value)).value;
}

oracles::PairTransport::Medium oracle_medium(double depth, double optical_depth, double g,
                                             double albedo) {
  return {wavenumber, depth, optical_depth / depth, albedo, [g](double angle) {
            return (1 - g * g) / (2 * pi * (1 + g * g - 2 * g * std::cos(angle)));
          }};
}

/// Returns the intensity along the normal and C_E for light and view tilted by q L, by the oracle.
std::vector<double> by_ordinates(double optical_depth, double g, double albedo, double q_depth) {
  constexpr double depth = 2000;
  const int panels = g < 0.8 ? 5 : 8;
  const double tilted = deflected(0, q_depth / depth);
  const auto medium = oracle_medium(depth, optical_depth, g, albedo);
  const std::vector<oracles::PairTransport::Pair> both = {{0, tilted}},
                                                  each = {{0, 0}, {tilted, tilted}};
  const oracles::PairTransport pair(medium, both, both, panels), alone(medium, each, each, panels);
  const double intensity = alone.covariance(0, 0).real();
  return {intensity,
          std::abs(pair.covariance(0, 0)) / std::sqrt(intensity * alone.covariance(1, 1).real())};
}

double backscattered(double d, bool reversed, double tolerance = 1e-8) {
  const auto request = intensity_request({0.0}, {far_view(pi - d)});
  return slab_covariance(hg_slab(200, {50, 0.5, 0.98}, request), reversed, {tolerance})
      .value[0]
      .real();
}

}  // namespace

namespace {

struct DeepSlab {
  double optical_depth, g, albedo;
};

}  // namespace

TEST_CASE(
    "slab transport: intensities and correlations of deep slabs agree with discrete ordinates") {
  for (const DeepSlab& slab : {DeepSlab{10, 0, 1}, DeepSlab{10, 0.8, 1}, DeepSlab{30, 0.9, 0.99}}) {
    CAPTURE(slab.g);
    const auto found =
                   intensity_correlation_ladder(slab.optical_depth, slab.g, slab.albedo, {1e-7}),
               expected = by_ordinates(slab.optical_depth, slab.g, slab.albedo, 2);
    for (std::size_t i = 0; i < expected.size(); ++i)
      CHECK(found[i] == doctest::Approx(expected[i]).epsilon(1e-5));
  }
  const oracles::IsotropicSlab theory(wavenumber, 2000, 10 / 2000.0, 0.9);
  CHECK(
      intensity_correlation_ladder(10, 0, 0.9, {1e-7})[2] ==
      doctest::Approx(theory.without_reversed({0, pi - 0.2}, {0, pi - 0.2}).real()).epsilon(3e-4));
}

TEST_CASE("slab transport: memory-effect range agrees with discrete ordinates") {
  for (const DeepSlab& slab : {DeepSlab{10, 0, 1}, DeepSlab{10, 0.5, 1}, DeepSlab{10, 0.9, 1},
                               DeepSlab{10, 0, 0.9}, DeepSlab{40, 0, 1}}) {
    if (!is_night && (slab.optical_depth < 40) == (slab.g < 0.9 && slab.albedo == 1)) continue;
    CAPTURE(slab.optical_depth);
    CAPTURE(slab.g);
    const double q_depth = half_width(slab.optical_depth, slab.g, slab.albedo),
                 correlation = by_ordinates(slab.optical_depth, slab.g, slab.albedo, q_depth)[1];
    CHECK(std::abs(correlation * correlation - 0.5) < 5e-5);
  }
}

TEST_CASE("slab transport: the cone of coherent backscattering agrees with Monte Carlo") {
  // exactly backwards, reversed paths double all that is scattered twice or more
  constexpr double optical_depth = 4, g = 0.5, albedo = 0.98;
  const double once =
                   albedo * (1 - g) / (2 * pi * (1 + g)) * (1 - std::exp(-2 * optical_depth)) / 2,
               ladder = backscattered(0, false);
  CHECK(std::abs(backscattered(0, true, 1e-7) - ladder - (ladder - once)) < 1e-6);
  const double distances[] = {0.002, 0.01, 0.05, 0.3};
  for (std::size_t i = 0; i < 4; ++i) {
    const double d = distances[i];
    CAPTURE(d);
    const auto request = intensity_request({0.0}, {far_view(pi - d)});
    const Scene scene = hg_slab(200, {50, g, albedo}, request);
    const auto found =
        tests::run(scene, ReversedPaths::yes, is_night ? 200000 : 60000, 40 + i).entries();
    const double expected = backscattered(d, true, 1e-6);
    CHECK_WITHIN_4_SIGMA(found.value[0], found.error[0], expected, 0);
    CHECK(found.error[0] < 0.015 * expected);
  }
}

TEST_CASE("slab transport: converges to nine digits") {
  for (const double g : {0.0, 0.9, -0.5}) {
    const auto fine = intensity_correlation_ladder(10, g, 0.99, {.tolerance = 1e-12, .fixed = Resolution{36, 1}}),
               coarse = intensity_correlation_ladder(10, g, 0.99, {1e-9});
    for (std::size_t i = 0; i < fine.size(); ++i)
      CHECK(coarse[i] == doctest::Approx(fine[i]).epsilon(1e-9));
  }
}

TEST_CASE("slab transport: entries are accurate to the tolerance") {
  constexpr double tolerance = 1e-3;
  for (const double g : {0.0, 0.8, 0.98}) {
    if (g != 0.8 && !is_night) continue;
    const auto request = memory_effect_request(wavenumber, 0.3, {0.1, pi - 0.4}, {0, 1e-4, 1e-3});
    const Scene scene = hg_slab(1000, {200, g, 0.95}, request);
    const auto rough = slab_covariance(scene, true, {tolerance}),
               exact = slab_covariance(scene, true, {1e-5});
    for (std::size_t e = 0; e < rough.value.size(); ++e) {
      const double intensity = std::abs(exact.value[request.reference_intensity(e % 2)]);
      CHECK(std::abs(rough.value[e] - exact.value[e]) <= tolerance * intensity);
      CHECK(std::abs(rough.error[e]) <= 2 * tolerance * intensity);
    }
  }
}

TEST_CASE("slab transport: tilts agree with the integral equation and pair transport") {
  constexpr double depth = 1000;
  for (const double light : {0.0, 0.4}) {
    for (const double tilt : {0.0, 1.0, -5.0, 20.0}) {  // q L
      if (!is_night && (light > 0) != (tilt > 0)) continue;
      const double q = tilt / depth, optical_depth = 3, view = -0.2;
      const AnglePair pair{light, view, deflected(light, q), deflected(view, q)};
      const auto request = pairs_request({pair});
      const Complex found =
          slab_covariance(hg_slab(depth, {depth / optical_depth, 0, 0.9}, request), false, {})
              .value[0];
      const oracles::IsotropicSlab theory(wavenumber, depth, optical_depth / depth, 0.9);
      const Complex expected = theory.without_reversed({light, view}, {pair.light2, pair.view2});
      CHECK(std::abs(found - expected) < 3e-4 * std::abs(expected));
      const double g = 0.7;
      const Complex peaked =
          slab_covariance(hg_slab(depth, {depth / optical_depth, g, 0.9}, request), false, {})
              .value[0];
      const oracles::PairTransport transport(oracle_medium(depth, optical_depth, g, 0.9),
                                             {{light, pair.light2}}, {{view, pair.view2}}, 5);
      CHECK(std::abs(peaked - transport.covariance(0, 0)) < 1e-5 * std::abs(peaked));
    }
  }
}

TEST_CASE("slab transport: reversed paths of isotropic slabs agree with the integral equation") {
  for (const double d : {0.0, 0.004, 0.03}) {
    const double light = 0.2, view = pi + light - d;
    const Scene scene = hg_slab(200, {50, 0, 0.95}, intensity_request({light}, {far_view(view)}));
    const oracles::IsotropicSlab theory(wavenumber, 200, 1 / 50.0, 0.95);
    CHECK(slab_covariance(scene, true, {}).value[0].real() ==
          doctest::Approx(theory.with_reversed({light, view}, {light, view}).real()).epsilon(3e-4));
  }
}

TEST_CASE("slab transport: thin and thick slabs agree with single scattering and diffusion") {
  const auto intensity = [](double optical_depth, double g, double albedo, double view) {
    const auto request = intensity_request({0.0}, {far_view(view)});
    return slab_covariance(hg_slab(1000, {1000 / optical_depth, g, albedo}, request), false, {})
        .value[0]
        .real();
  };
  const double thin = 1e-3;
  CHECK(intensity(thin, 0, 1, 0.3) == doctest::Approx(thin / (2 * pi)).epsilon(5e-3));
  // diffusion: transmission falls as 1 / (depth + 2 z0), z0 = 0.818 transport mean free paths
  for (const double g : {0.0, 0.8}) {
    const double once = intensity(5e3 / (1 - g), g, 1, 0),
                 twice = intensity(1e4 / (1 - g), g, 1, 0);
    CHECK(once / twice == doctest::Approx((1e4 + 2 * 0.8181) / (5e3 + 2 * 0.8181)).epsilon(1e-6));
  }
  // absorption: the same factor for equal lengths
  const double one = intensity(40, 0, 0.9, 0), two = intensity(60, 0, 0.9, 0),
               three = intensity(80, 0, 0.9, 0);
  CHECK(one / two == doctest::Approx(two / three).epsilon(1e-6));
}

TEST_CASE("slab transport: very deep absorbing slabs attenuate at the diffusion rate") {
  const auto intensity = [](double optical_depth) {
    const auto request = intensity_request({0.0}, {far_view(0)});
    return slab_covariance(hg_slab(1000, {1000 / optical_depth, 0, 0.9}, request), false, {1e-8})
        .value[0]
        .real();
  };
  // isotropic in the plane: albedo = sqrt(1 - rate^2)
  const double rate = std::sqrt(1 - 0.9 * 0.9);
  for (const double optical_depth : {200.0, 400.0, 800.0})
    CHECK(std::log(intensity(optical_depth) / intensity(optical_depth + 100)) ==
          doctest::Approx(100 * rate).epsilon(1e-9));
}

TEST_CASE("slab transport: values and errors of the job equal those of the solution") {
  const auto request = intensity_request({0, 0.2}, {far_view(0), far_view(2.5)});
  const Scene scene = hg_slab(1000, {200, 0.5, 1}, request);
  const auto refined = slab_covariance(scene, false, {});
  const FieldJob job = slab_covariance_job(scene, false, {});
  const auto found = jackknife(tests::summed(job.batches, 2), job.covariance);
  for (std::size_t e = 0; e < refined.value.size(); ++e) {
    CHECK(std::abs(found.value[e] - refined.value[e]) < 1e-14);
    CHECK(found.error[e] == doctest::Approx(std::abs(refined.error[e])).epsilon(1e-6));
  }
}

TEST_CASE("slab transport: temporal correlation agrees with Monte Carlo") {
  const std::vector<double> delays = {0.003, 0.03, 0.3};
  for (const double g : {0.0, 0.8}) {
    const auto request = intensity_request({0.2}, {far_view(0.5), far_view(pi + 0.2)});
    const Scene scene = hg_slab(300, {60, g, 0.97}, request);
    const auto job = delay_job(scene, make_plan(scene, ReversedPaths::yes), delays, 5);
    const auto sums = tests::summed(job.field.batches, is_night ? 200000 : 60000);
    const auto found = change_estimates(request, job, sums).covariance;
    for (std::size_t t = 0; t < delays.size(); ++t) {
      const auto expected =
          slab_covariance(scene, true, {is_night ? 1e-5 : 1e-3}, {.delay = delays[t]}).value;
      for (std::size_t v = 0; v < 2; ++v) {
        const std::size_t e = 2 * t + v;
        CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected[v], 0);
        CHECK(found.error[e] < 0.05 * std::abs(expected[v]));
      }
    }
  }
}

TEST_CASE("slab transport: tilts with delays of a thick slab agree with diffusion theory") {
  constexpr double depth = 1000, optical_depth = 1000;
  const std::vector<double> tilts = {0, 1e-4, 3e-4}, delays = {0, 2e-7, 1e-6};
  const auto request = memory_effect_request(wavenumber, 0, {0}, tilts);
  const Scene scene = hg_slab(depth, {depth / optical_depth, 0.3}, request);
  std::vector<FieldChange> changes;
  for (const double delay : delays) changes.push_back({.delay = delay});
  const auto job = slab_change_job(scene, false, {}, changes);
  const auto sums = tests::summed(job.field.batches, 2);
  const auto found = change_estimates(request, job, sums);
  const auto still = slab_covariance(scene, false, {}).value;
  for (std::size_t i = 0; i < tilts.size(); ++i) {
    CHECK(std::abs(found.covariance.value[i] - still[i]) < 1e-14);
    for (std::size_t t = 0; t < delays.size(); ++t) {
      CAPTURE(i);
      CAPTURE(t);
      // like absorption, a delay adds to the square of a tilt (C20)
      const double loss = 2 * delays[t] * (1 - scene.medium.g) * scene.medium.mu_s,
                   l = scene.medium.transport_mean_free_path(), q = request.tilt_q[i],
                   expected = diffusion_field_correlation(scene, std::sqrt(q * q + 2 * loss / l));
      CHECK(found.correlation.value[t * tilts.size() + i].real() ==
            doctest::Approx(expected).epsilon(2e-3));
    }
  }
}

TEST_CASE("slab transport: errors hold for few ordinates, also those of correlations") {
  // in a thin slab two solutions may agree by accident; fields that change little err alike
  for (const double optical_depth : {1e-3, 1.0, 30.0})
    for (const double g : {-0.9, 0.0, 0.5, 0.9, 0.98}) {
      if (!is_night && (optical_depth > 1 || g > 0)) continue;
      CAPTURE(optical_depth);
      CAPTURE(g);
      const auto request = memory_effect_request(wavenumber, 0, {0.2, 2.9}, {0, 0.02, 0.1});
      const Scene scene = hg_slab(100, {100 / optical_depth, g}, request);
      const auto found = [&](double tolerance) {
        const auto job = slab_change_job(scene, false, {tolerance},
                                         {{.delay = 0}, {.delay = 0.01}, {.shift = 1e-4}});
        return change_estimates(request, job, tests::summed(job.field.batches, 2));
      };
      const auto rough = found(1e-2), fine = found(1e-5);
      for (auto quantity : {&ChangeEstimates::covariance, &ChangeEstimates::correlation}) {
        const Estimate &few = rough.*quantity, &many = fine.*quantity;
        for (std::size_t e = 0; e < few.value.size(); ++e)
          CHECK(std::abs(few.value[e] - many.value[e]) <=
                few.error[e] + many.error[e] + 1e-12 * std::abs(few.value[e]));
      }
    }
}

namespace {

/// Checks derivatives against differences of the scenes at(step); `scale` is the step over which
/// the values change.
template <typename At>
void check_derivatives(BulkParameter parameter, double scale, bool reversed, const At& at) {
  CAPTURE(static_cast<int>(parameter));
  const Refinement refinement{is_night ? 1e-9 : 1e-8, 8};
  tests::check_sixth_order(
      slab_derivatives(at(0), reversed, refinement, parameter).value, scale,
      [&](double step) { return slab_covariance(at(step), reversed, refinement).value; });
}

}  // namespace

TEST_CASE("slab transport: derivatives agree with finite differences of converged solutions") {
  struct Case {
    double optical_depth, g, albedo, view;
    bool reversed;
  };
  constexpr double depth = 200;
  for (const Case& slab : {Case{3, 0, 1, 0.1, false}, Case{2, 0.6, 0.9, pi + 0.201, true}}) {
    if (!is_night && !slab.reversed) continue;  // by day the one with all of the parameters
    CAPTURE(slab.g);
    const auto request = memory_effect_request(wavenumber, 0.2, {slab.view}, {0, 0.5 / depth});
    const auto scene = [&](double mu_t, double g, double albedo) {
      return hg_slab(depth, {1 / mu_t, g, albedo}, request);
    };
    const double mu_t = slab.optical_depth / depth;
    check_derivatives(BulkParameter::mu_t, mu_t, slab.reversed,
                      [&](double step) { return scene(mu_t + step, slab.g, slab.albedo); });
    check_derivatives(BulkParameter::g, 1 - std::abs(slab.g), slab.reversed,
                      [&](double step) { return scene(mu_t, slab.g + step, slab.albedo); });
    if (slab.albedo < 1)
      check_derivatives(BulkParameter::albedo, slab.albedo, slab.reversed,
                        [&](double step) { return scene(mu_t, slab.g, slab.albedo + step); });
  }
}

TEST_CASE("slab transport: derivatives by radius and index of cylinders agree with differences") {
  constexpr double depth = 200, radius = 0.2, index = 1.4;
  for (const char* kind : {"te", "soft"}) {
    CAPTURE(kind);
    const auto request = memory_effect_request(wavenumber, 0.2, {0.1}, {0, 0.5 / depth});
    const auto scene = [&](double wider, double denser) {
      SceneSpec spec;
      spec.domain = "slab";
      spec.depth = depth;
      spec.scatterer = kind;
      spec.radius = radius + wider;
      spec.density = 0.05;
      if (spec.scatterer == "te") spec.index = std::to_string(index + denser) + "+0.01i";
      Scene made = make_scene(spec);
      made.request = request;
      return made;
    };
    check_derivatives(BulkParameter::radius, radius / 4, false,
                      [&](double step) { return scene(step, 0); });
    if (scene(0, 0).scatterer.is_penetrable())
      check_derivatives(BulkParameter::index, 0.1, false,
                        [&](double step) { return scene(0, step); });
  }
}

TEST_CASE("random slabs: Monte Carlo agrees with transport") {
  for (std::uint64_t seed = 1; seed <= (is_night ? 5 : 2); ++seed) {
    const Scene scene = tests::RandomSlab(seed).scene();
    const auto expected = slab_covariance(scene, true, {is_night ? 1e-5 : 1e-4}).value;
    const auto found =
        tests::run(scene, ReversedPaths::yes, is_night ? 30000 : 20000, seed).entries();
    CAPTURE(seed);
    for (std::size_t e = 0; e < expected.size(); ++e) {
      CAPTURE(e);
      CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], expected[e], 0);
    }
  }
}

}  // namespace flatspeckle::mc::test_slab_covariance
