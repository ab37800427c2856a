// Fields at two frequencies by Monte Carlo, against transport, closed forms and diffusion theory.
#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "flatland/scene/frequency_shift.h"
#include "mc/paths/dynamics/frequency_shifts.h"
#include "mc/slab/slab_covariance.h"
#include "mc/slab/slab_jobs.h"
#include "mc/theory/diffusion.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_frequency_walks {

namespace {

using tests::pi;

struct FrequencyRun {
  CovarianceRequest request;
  PathJob job;
  GroupedSums sums;

  Estimate intensity() const { return jackknife(sums, job.field.covariance); }
  ChangeEstimates changes() const { return change_estimates(request, job, sums); }
};

FrequencyRun run_at(const Scene& scene, const Plan& plan, const std::vector<double>& shifts,
                    std::uint64_t paths, std::uint64_t seed) {
  FrequencyRun result{scene.request, frequency_job(scene, plan, shifts, seed), {}};
  result.sums = tests::summed(result.job.field.batches, paths);
  return result;
}

FrequencyRun run_at(const Scene& scene, ReversedPaths reversed, const std::vector<double>& shifts,
                    std::uint64_t paths, std::uint64_t seed) {
  return run_at(scene, frequency_plan(scene, reversed), shifts, paths, seed);
}

CovarianceRequest intensities_around() {
  return intensity_request({0.2, -0.4}, tests::far_views({0.1, 1.2, pi - 0.3, pi + 0.2}));
}

/// Compares Monte Carlo with transport on a slab.
void check_slab(const Scene& slab, bool reversed, const std::vector<double>& shifts, double most) {
  const auto found =
      run_at(slab, reversed ? ReversedPaths::yes : ReversedPaths::no, shifts, 60000, 1).changes();
  std::vector<FieldChange> changes;
  for (const double shift : shifts) changes.push_back({.shift = shift});
  const auto job = slab_change_job(slab, reversed, {1e-5}, changes);
  const auto expected = change_estimates(slab.request, job, tests::summed(job.field.batches, 2));
  for (std::size_t i = 0; i < found.covariance.value.size(); ++i)
    CHECK_WITHIN_4_SIGMA(found.covariance.value[i], found.covariance.error[i],
                         expected.covariance.value[i], 0);
  for (std::size_t i = 0; i < found.correlation.value.size(); ++i) {
    CHECK_WITHIN_4_SIGMA(found.correlation.value[i], found.correlation.error[i],
                         expected.correlation.value[i], 1e-12);
    CHECK(found.correlation.error[i] < most);
  }
}

}  // namespace

TEST_CASE("frequency correlation: without a shift the second field equals the first") {
  for (const auto reversed : {ReversedPaths::yes, ReversedPaths::no}) {
    for (const double albedo : {1.0, 0.8}) {
      const Scene scene = tests::hg_box(20, 10, {4, 0.5, albedo}, intensities_around());
      const auto run = run_at(scene, reversed, {0, 0.02}, 4000, 1);
      const auto alone = tests::run(scene, reversed, 4000, 1).entries();
      const auto changes = run.changes();
      for (std::size_t c = 0; c < alone.value.size(); ++c) {
        CHECK(std::abs(run.intensity().value[c] - alone.value[c]) < 1e-12 * alone.value[c].real());
        CHECK(std::abs(changes.correlation.value[c] - 1.0) < 1e-12);
        CHECK(std::abs(changes.correlation.value[alone.value.size() + c]) < 0.99);
      }
    }
  }
}

TEST_CASE("frequency correlation of slabs: Monte Carlo agrees with transport") {
  const std::vector<double> shifts = {-2e-4, 1e-4, 5e-4};
  check_slab(tests::hg_slab(60, {20, 0.4, 0.95}, intensity_request({0.3}, {far_view(-0.2)})), false,
             shifts, 0.01);
  check_slab(tests::hg_slab(60, {20, 0.4}, intensity_request({0.1}, {far_view(pi + 0.1)})), true,
             shifts, 0.01);
  check_slab(tests::hg_slab(100, {20}, memory_effect_request(2 * pi, 0, {0.1}, {0, 1e-3, 4e-3})),
             false, shifts, 0.01);
}

TEST_CASE("frequency correlation: sampled single scattering agrees with the closed form") {
  const Scene scene = tests::hg_box(20, 10, {8, 0.3, 0.5}, intensities_around());
  Plan plan = frequency_plan(scene, ReversedPaths::yes);
  REQUIRE_FALSE(plan.sampled_single);
  const auto exact = run_at(scene, plan, {0.01, -0.03}, 50000, 3).changes().covariance;
  plan.sampled_single = true;
  const auto sampled = run_at(scene, plan, {0.01, -0.03}, 100000, 4).changes().covariance;
  for (std::size_t i = 0; i < exact.value.size(); ++i)
    CHECK_WITHIN_4_SIGMA(sampled.value[i], std::hypot(sampled.error[i], exact.error[i]),
                         exact.value[i], 0);
}

TEST_CASE(
    "frequency correlation of deep slabs: Monte Carlo and transport agree with diffusion theory") {
  // x^2 = 2 |k1 - k2| depth^2 / l*: the correlation falls to about 0.87, 0.6 and 0.4.
  for (const auto& [optical_depth, bias] : {std::pair{10.0, 0.07}, {20.0, 0.02}}) {
    const double mean_free_path = 20, depth = optical_depth * mean_free_path;
    const Scene scene =
        tests::hg_slab(depth, {mean_free_path}, intensity_request({0}, {far_view(0)}));
    std::vector<double> shifts;
    for (const double x : {2.0, 3.0, 4.0})
      shifts.push_back(x * x * mean_free_path / (2 * depth * depth) / scene.k);
    const auto found = run_at(scene, ReversedPaths::no, shifts, 40000, 7).changes().correlation;
    for (std::size_t i = 0; i < shifts.size(); ++i) {
      const double theory = diffusion_frequency_correlation(scene, scene.k, shifts[i]);
      CHECK_WITHIN_4_SIGMA(std::abs(found.value[i]), found.error[i], Complex(theory),
                           bias * theory);
      CHECK(found.error[i] < 0.02);
      const Complex exact = slab_covariance(scene, false, {1e-6}, {.shift = shifts[i]}).value[0] /
                            slab_covariance(scene, false, {1e-6}).value[0];
      CHECK(std::abs(std::abs(exact) - theory) < bias * theory);
    }
  }
}

TEST_CASE("frequency shifts: rejected if a field has no counterpart at the second frequency") {
  const auto check = [](const CovarianceRequest& request, double shift) {
    check_frequency_shifts(request, {shift});
  };
  check(intensities_around(), 0.05);
  CHECK_THROWS_AS(check(intensities_around(), 0.11), InputError);
  CHECK_THROWS_AS(check(intensities_around(), std::nan("")), InputError);
  CHECK_THROWS_AS(check(full_request({0}, tests::far_views({0.1})), 0.01), InputError);
  CHECK_THROWS_AS(check(intensity_request({0}, {near_sensor({0, -5})}), 0.01), InputError);
  CHECK_THROWS_AS(check(intensity_request({1.5}, {far_view(-1.5)}), -0.1), InputError);
}

}  // namespace flatspeckle::mc::test_frequency_walks
