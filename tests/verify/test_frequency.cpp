// Correlation of fields at two frequencies: exact solutions of the same placements at both
// frequencies against Monte Carlo, on an absolute scale.
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "flatland/scene/frequency_shift.h"
#include "mc/paths/dynamics/frequency_shifts.h"
#include "tests/statistics.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::test_frequency {

namespace {

constexpr double pi = std::numbers::pi;
const std::vector<double> shifts = {1e-3, 5e-3, 0.02, -0.05};

Scene box_of_points(const std::string& covariance) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.density = 31.0 / 200;
  spec.covariance = covariance;
  if (covariance == "intensity") {
    spec.light_angles = {0.2};
    spec.view_angles = {0.5, 1.2, pi - 0.7, pi + 0.2};
  } else {
    spec.view_angles = {0.3, pi - 0.4};
    spec.tilts = {0, 0.02};
  }
  return make_scene(spec);
}

mc::ChangeEstimates estimates(const Scene& scene, const mc::PathJob& job, std::uint64_t samples) {
  RunOptions options;
  options.stop.samples =
      static_cast<std::uint64_t>(tests::effort().samples * static_cast<double>(samples));
  RunState state;
  run_batches(job.field.batches, options, state);
  return mc::change_estimates(scene.request, job, state.sums);
}

void check(const Scene& scene, std::uint64_t placements) {
  const auto [field, all] = wave::frequency_job(scene, shifts, 1, 1e-6);
  const auto exact =
      estimates(scene, {field, all, scene.request.entries.size()}, placements).correlation;
  const auto plan = mc::frequency_plan(scene, mc::ReversedPaths::automatic);
  REQUIRE(plan.reversed);
  const auto mc = estimates(scene, mc::frequency_job(scene, plan, shifts, 1), 200'000).correlation;

  const double bias =
      2 / (scene.k * scene.medium.mean_free_path());  // allowance for the bias of Monte Carlo
  const auto entries = static_cast<double>(mc.value.size());
  double deviations = 0, variances = 0;
  for (std::size_t i = 0; i < mc.value.size(); ++i) {
    const double error = std::hypot(mc.error[i], exact.error[i]);
    INFO("correlation ", i, ": exact ", exact.value[i].real(), " ", exact.value[i].imag(),
         " i, Monte Carlo ", mc.value[i].real(), " ", mc.value[i].imag(), " i +- ", error);
    CHECK(std::abs(mc.value[i] - exact.value[i]) < 4 * error + bias);
    CHECK(error < 0.015 * tests::effort().errors);
    deviations += std::norm(mc.value[i] - exact.value[i]);
    variances += error * error;
  }
  // Values of one detection direction share placements and paths; those of different directions are
  // independent. The ratio of the mean squared deviation to the mean squared error is therefore 1
  // with a standard deviation of about 1 / sqrt(views), because each value has a real and an
  // imaginary part.
  const auto views = static_cast<double>(scene.request.moves > 0 ? scene.request.reference_views
                                                                 : scene.request.views.size());
  CHECK(deviations < variances * (1 + 4 / std::sqrt(views)) + entries * bias * bias);
}

}  // namespace

TEST_CASE("frequency correlation: exact fields agree with Monte Carlo (k mfp = 63)") {
  const Scene scene = box_of_points("intensity");
  CHECK(scene.k * scene.medium.mean_free_path() == doctest::Approx(63.7).epsilon(0.01));
  check(scene, 10'000);
}

TEST_CASE("frequency correlation: tilted illumination agrees with Monte Carlo") {
  check(box_of_points("memory_effect"), 5'000);
}

TEST_CASE("frequency ensemble: shift 0 equals the ensemble of one frequency") {
  const Scene scene = box_of_points("intensity");
  const auto sums = [&](const FieldJob& job) {
    std::vector<Complex> values(job.batches.size);
    job.batches.run(3, values);
    return values;
  };
  const auto alone = sums(wave::wave_job(scene, 1, 1e-6)),
             same = sums(wave::frequency_job(scene, {0}, 1, 1e-6).field);
  const std::size_t channels = scene.request.channels.size();
  REQUIRE(alone.size() == 2 * channels);
  for (std::size_t i = 0; i < alone.size(); ++i) {
    CHECK(same[i] == alone[i]);
    CHECK(std::abs(same[2 * channels + i] - alone[i]) < 1e-12 * std::abs(alone[i]));
  }
}

}  // namespace flatspeckle::test_frequency
