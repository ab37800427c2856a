#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "mc/paths/dynamics/brownian.h"
#include "mc/theory/diffusing_waves.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_brownian {

namespace {

using tests::HgBulk;
using tests::pi;

struct DelayRun {
  CovarianceRequest request;
  PathJob job;
  GroupedSums sums;

  Estimate intensity() const { return jackknife(sums, job.field.covariance); }
  Estimate covariance() const { return change_estimates(request, job, sums).covariance; }
  Estimate correlation() const { return change_estimates(request, job, sums).correlation; }
};

DelayRun diffuse(const Scene& scene, const Plan& plan, const std::vector<double>& delays,
                 std::uint64_t paths, std::uint64_t seed) {
  DelayRun result{scene.request, delay_job(scene, plan, delays, seed), {}};
  result.sums = tests::summed(result.job.field.batches, tests::shortened(paths));
  return result;
}

DelayRun diffuse(const Scene& scene, ReversedPaths reversed, const std::vector<double>& delays,
                 std::uint64_t paths, std::uint64_t seed) {
  return diffuse(scene, make_plan(scene, reversed), delays, paths, seed);
}

const std::vector<double> lights = {0.2, -0.4};
const std::vector<double> views = {0.1, 1.2, pi - 0.3, pi + 0.2};

CovarianceRequest intensities() {
  return intensity_request(lights, tests::far_views(views));
}

/// Returns a static medium whose scattering loses what a delay takes from it: p exp(-2 t (1 - cos))
/// is a phase function times a factor. Isotropic p only: exp(t cos) = sum I_n(t) cos(n theta).
Scene with_losses(Scene scene, double delay) {
  BulkMedium& medium = scene.medium;
  medium.t_matrix.clear();
  for (int n = 0; n < 30; ++n)
    medium.t_matrix.emplace_back(std::cyl_bessel_il(n, static_cast<long double>(delay)));
  medium.cross_sections = cross_sections(medium.t_matrix, scene.k);
  const double kept = std::exp(-2 * delay) * std::cyl_bessel_i(0, 2 * delay);
  medium.albedo *= kept;
  medium.mu_s *= kept;
  medium.density = medium.mu_s / medium.cross_sections.scattering;
  medium.g = std::cyl_bessel_i(1, 2 * delay) / std::cyl_bessel_i(0, 2 * delay);
  scene.scatterer.kind = Scatterer::Kind::tm;  // amplitudes by table
  return scene;
}

}  // namespace

TEST_CASE("temporal correlation: 1 at zero delay, intensities equal those of static scatterers") {
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no}) {
    for (const double albedo : {1.0, 0.8}) {
      const Scene scene = tests::hg_box(20, 10, {4, 0.5, albedo}, intensities());
      const auto run = diffuse(scene, reversed, {0, 0.3}, 4000, 1);
      const auto still = tests::run(scene, reversed, 4000, 1).entries();
      const auto intensity = run.intensity(), covariance = run.covariance();
      for (std::size_t c = 0; c < still.value.size(); ++c) {
        CHECK(intensity.value[c].real() == doctest::Approx(still.value[c].real()).epsilon(1e-12));
        CHECK(covariance.value[c].real() == doctest::Approx(still.value[c].real()).epsilon(1e-12));
        CHECK(run.correlation().value[c].real() == doctest::Approx(1).epsilon(1e-12));
        CHECK(covariance.value[still.value.size() + c].real() < 0.9 * still.value[c].real());
      }
    }
  }
}

TEST_CASE("temporal correlation of a thin medium: agrees with exp(-q^2 D tau)") {
  const std::vector<double> delays = {0.1, 1, 4};
  for (const double g : {0.0, 0.6}) {
    const Scene scene = tests::hg_box(20, 10, {1e8, g}, intensities());
    for (const bool sampled : {false, true}) {
      Plan plan = make_plan(scene, ReversedPaths::no);
      plan.sampled_single = sampled;
      const auto found = diffuse(scene, plan, delays, 1000, 2).correlation();
      std::size_t i = 0;
      for (const double delay : delays) {
        for (const Channel c : scene.request.channels) {
          const double turn = views[c.view] - lights[c.light];
          // q = 2 k sin(turn/2)
          CHECK(found.value[i++].real() ==
                doctest::Approx(std::exp(-4 * delay * std::pow(std::sin(turn / 2), 2)))
                    .epsilon(1e-5));
        }
      }
    }
  }
}

TEST_CASE("temporal correlation: sampled single scattering agrees with the closed form") {
  const Scene scene = tests::hg_box(20, 10, {8, 0.3, 0.5}, intensities());
  Plan plan = make_plan(scene, ReversedPaths::yes);
  REQUIRE_FALSE(plan.sampled_single);
  const auto exact = diffuse(scene, plan, {0.2, 1}, 50000, 3).covariance();
  plan.sampled_single = true;
  const auto sampled = diffuse(scene, plan, {0.2, 1}, 100000, 4).covariance();
  for (std::size_t i = 0; i < exact.value.size(); ++i)
    CHECK_WITHIN_4_SIGMA(sampled.value[i], std::hypot(sampled.error[i], exact.error[i]),
                         exact.value[i], 0);
}

TEST_CASE("temporal correlation: diffusing isotropic scatterers equal static ones with losses") {
  const double delay = 0.25;
  for (const auto reversed : {ReversedPaths::no, ReversedPaths::yes}) {
    for (const double albedo : {1.0, 0.9}) {
      const Scene scene = tests::hg_box(20, 10, {3, 0, albedo}, intensities());
      const auto moving = diffuse(scene, reversed, {delay}, 200000, 5).covariance();
      const auto still = tests::run(with_losses(scene, delay), reversed, 200000, 6).entries();
      for (std::size_t c = 0; c < still.value.size(); ++c) {
        CAPTURE(c);
        CHECK_WITHIN_4_SIGMA(moving.value[c], std::hypot(moving.error[c], still.error[c]),
                             still.value[c], 0);
        CHECK(std::hypot(moving.error[c], still.error[c]) < 0.02 * still.value[c].real());
      }
    }
  }
}

TEST_CASE("temporal correlation of a thick slab: agrees with diffusion theory to 5 %") {
  const double depth = 40;
  for (const double g : {0.0, 0.6}) {
    CAPTURE(g);
    const double transport_length = 1;
    const Scene scene = tests::hg_slab(depth, {transport_length * (1 - g), g},
                                       intensity_request({0}, {far_view(0)}));
    const std::vector<double> delays = {2e-4, 1e-3, 2e-3};
    const auto found = diffuse(scene, ReversedPaths::no, delays, 40000, 7).correlation();
    for (std::size_t t = 0; t < delays.size(); ++t) {
      // Q l* = 2 sqrt(t), well known as sqrt(6 t) in three dimensions
      const double x = 2 * std::sqrt(delays[t]) * depth / transport_length,
                   textbook = x / std::sinh(x);
      const double theory = diffusing_wave_correlation(scene, delays[t], ExitSide::transmitted);
      CHECK_WITHIN_4_SIGMA(found.value[t], found.error[t], Complex(theory), 0.05 * theory);
      CHECK(std::abs(theory - textbook) < 0.1 * textbook);  // no extrapolation length
      CHECK(found.error[t] < 0.03 * theory);
    }
  }
}

TEST_CASE("delays: negative and NaN delays and full covariances are rejected") {
  const auto refused = [](const CovarianceRequest& request, double delay) {
    const Scene scene = tests::hg_box(20, 10, {4}, request);
    CHECK_THROWS_AS(delay_job(scene, make_plan(scene, ReversedPaths::no), {delay}, 1), InputError);
  };
  refused(intensities(), -0.1);
  refused(intensities(), std::nan(""));
  refused(full_request({0}, tests::far_views(views)), 0.1);
}

TEST_CASE("delays: scatterers at correlated positions are rejected") {
  Scene scene = tests::hg_box(20, 10, {4}, intensities());
  scene.medium.structure = StructureFactor("test", {0, 1}, {0.5, 1});
  CHECK_THROWS_AS(delay_job(scene, make_plan(scene, ReversedPaths::no), {0.1}, 1), InputError);
}

TEST_CASE("temporal correlation: zero without scattering") {
  const Scene scene = tests::hg_box(20, 10, {4, 0, 0}, intensities());
  const auto run = diffuse(scene, ReversedPaths::no, {0.1}, 1000, 8);
  for (const Complex value : run.correlation().value) CHECK(value == 0.0);
}

}  // namespace flatspeckle::mc::test_brownian
