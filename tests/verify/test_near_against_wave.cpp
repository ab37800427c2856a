// Near sources, beams, sensors inside the medium and tilt-shift maps: Monte Carlo against the exact
// solver, on an absolute scale. Inside the medium both give the variance of the scattered field
// over placements, and both include scatterers arbitrarily close to the sensor, whose field is H_0
// without its far-field approximation (C13).
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "flatland/scene/scene.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "tests/statistics.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::test_near_against_wave {

namespace {

constexpr double pi = std::numbers::pi;

Scene box_points(const CovarianceRequest& request) {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  spec.density = 31.0 / 200;
  Scene scene = make_scene(spec);
  scene.request = request;
  return scene;
}

FieldMoments estimate(const FieldJob& job, std::uint64_t samples) {
  RunOptions options;
  options.stop.samples =
      static_cast<std::uint64_t>(tests::effort().samples * static_cast<double>(samples));
  RunState state;
  run_batches(job.batches, options, state);
  return field_moments(job, state.sums);
}

/// Checks agreement within 4 combined standard errors, or within 3 %, the measured bias of Monte
/// Carlo at k mfp = 63 (mfp: mean free path).
void check_agreement(const CovarianceRequest& request, std::uint64_t paths,
                     std::uint64_t placements) {
  const Scene scene = box_points(request);
  const auto plan = mc::make_plan(scene, mc::ReversedPaths::automatic);
  const auto mc = estimate(mc::covariance_job(scene, plan, 1), paths).covariance;
  const auto wave = estimate(wave::wave_job(scene, 1, 1e-6), placements).covariance;
  for (std::size_t e = 0; e < wave.value.size(); ++e) {
    CAPTURE(e);
    const double error = std::hypot(mc.error[e], wave.error[e]);
    INFO("mc ", std::abs(mc.value[e]), " +- ", mc.error[e], ", wave ", std::abs(wave.value[e]),
         " +- ", wave.error[e]);
    CHECK(std::abs(mc.value[e] - wave.value[e]) <
          std::max(4 * error, 0.03 * std::abs(wave.value[e])));
    // otherwise the test could not detect wrong intensities
    if (request.entries[e].a == request.entries[e].b)
      CHECK(error < 0.1 * tests::effort().errors * std::abs(wave.value[e]));
  }
}

}  // namespace

TEST_CASE("sensors inside the medium: Monte Carlo agrees with the exact solver") {
  check_agreement(intensity_request({0.0, 0.4}, {near_sensor({0, 5}), near_sensor({4, 2}),
                                                 near_sensor({-9.5, 9}), near_sensor({0, 0})}),
                  200'000, 6'000);
}

TEST_CASE("near sources outside and inside the medium: Monte Carlo agrees with the exact solver") {
  const Lights sources = {point_source({0, -5}), point_source({3, 4}), point_source({14, 5})};
  check_agreement(intensity_request(sources, {far_view(0.3), far_view(pi - 0.3), far_view(1.2)}),
                  200'000, 6'000);
  check_agreement(intensity_request(sources, {near_sensor({0, 14}), near_sensor({3.3, 4.3})}),
                  200'000, 6'000);
}

TEST_CASE("Gaussian beams: Monte Carlo agrees with the exact solver") {
  const Lights beams = {gaussian_beam(0, {0, 0}, 3), gaussian_beam(0.4, {-2, 5}, 2),
                        gaussian_beam(pi / 2, {0, 5}, 3)};
  check_agreement(intensity_request(beams, {far_view(0.6), far_view(pi - 0.3), near_sensor({0, 14}),
                                            near_sensor({1, 6})}),
                  200'000, 6'000);
}

TEST_CASE(
    "tilt-shift maps and translation of a near source: Monte Carlo agrees with the exact solver") {
  const std::vector<View> views = {far_view(0.5), far_view(pi - 0.4)};
  for (const Light& light : {plane_wave(0), gaussian_beam(0, {0, 0}, 4)})
    check_agreement(tilt_shift_request(2 * pi, light, views, {0, 0.03}, {0, 0.15, -0.2}), 200'000,
                    4'000);
  check_agreement(translation_request(point_source({0, -3}), {near_sensor({0, 13})}, {0, 0.5, 2}),
                  200'000, 4'000);
}

}  // namespace flatspeckle::test_near_against_wave
