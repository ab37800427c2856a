// Compares Monte Carlo with the exact solver, on an absolute scale without fitted parameters. If
// they differ by more than 4 combined standard errors, the difference must be within the bias of
// Monte Carlo: corrections of the order of 1/(k mean free path), and, for hard disks, of the
// packing fraction.
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/coherent_field.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "tests/statistics.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::test_wave_against_mc {

namespace {

constexpr double pi = std::numbers::pi;
using flatspeckle::tests::is_night;

SceneSpec box() {
  SceneSpec spec;
  spec.width = 20;
  spec.depth = 10;
  return spec;
}

SceneSpec box_points() {
  SceneSpec spec = box();
  spec.count = 31;
  spec.covariance = "memory_effect";
  spec.view_angles = {0.1, 0.5, 0.8, pi - 0.3, pi};
  spec.tilts = {0, std::asin(0.04), std::asin(0.16)};
  return spec;
}

FieldMoments estimate(const FieldJob& job, std::uint64_t samples) {
  RunOptions options;
  options.stop.samples = samples;
  RunState state;
  run_batches(job.batches, options, state);
  return field_moments(job, state.sums);
}

FieldMoments by_mc(const Scene& scene, std::uint64_t paths) {
  const auto plan = mc::make_plan(scene, mc::ReversedPaths::automatic);
  return estimate(mc::covariance_job(scene, plan, 1), is_night ? paths : paths / 3);
}

FieldMoments by_wave(const Scene& scene, std::uint64_t placements) {
  return estimate(wave::wave_job(scene, 1, is_night ? 1e-6 : 1e-3), placements);
}

void check_agreement(const FieldMoments& mc, const FieldMoments& wave, double bias) {
  for (std::size_t e = 0; e < wave.covariance.value.size(); ++e) {
    CAPTURE(e);
    const Complex a = mc.covariance.value[e], b = wave.covariance.value[e];
    const double error = std::hypot(mc.covariance.error[e], wave.covariance.error[e]);
    CHECK(std::abs(a - b) < std::max(4 * error, bias * std::abs(b)));
  }
}

}  // namespace

TEST_CASE(
    "resonant points: covariance, memory effect and backscattering agree with the exact solver") {
  const Scene scene = make_scene(box_points());
  const auto mc = by_mc(scene, 1'000'000), wave = by_wave(scene, 10'000);
  check_agreement(mc, wave, 0.03);

  // Reference values of another program for this scene: 2e6 paths, errors about 1e-3, and 2e4 exact
  // placements, errors up to 0.024.
  struct Row {
    std::size_t tilt, view;
    Complex mc, wave;
  };
  for (const Row& row : {Row{0, 0, 2.1113, 2.143},
                         {1, 0, {1.6794, -0.2163}, {1.712, -0.208}},
                         {2, 0, {1.0990, -0.6222}, {1.114, -0.636}},
                         {1, 1, {1.1670, -0.9874}, {1.153, -0.976}},
                         {0, 2, 1.9586, 1.940},
                         {0, 3, 2.4131, 2.478},
                         {0, 4, 3.3039, 3.323},
                         {1, 4, {2.4577, 0.0918}, {2.498, 0.091}}}) {
    CAPTURE(row.tilt);
    CAPTURE(row.view);
    const auto e = scene.request.tilted_entry(row.tilt, row.view);
    const auto near = [](const Estimate& estimate, std::size_t i, Complex value, double error) {
      return std::abs(estimate.value[i] - value) < 4 * std::hypot(estimate.error[i], error);
    };
    CHECK(near(mc.covariance, e, row.mc, 1.5e-3));
    CHECK(near(wave.covariance, e, row.wave, 0.02));
  }
}

TEST_CASE("absorbing points: covariance agrees with the exact solver") {
  SceneSpec spec = box_points();
  spec.count = 39;
  spec.albedo = 0.8;
  const Scene scene = make_scene(spec);
  const auto mc = by_mc(scene, 500'000);
  check_agreement(mc, by_wave(scene, 10'000), 0.03);
  const auto intensity = [&](std::size_t view) {
    return mc.covariance.value[scene.request.reference_intensity(view)].real();
  };
  CHECK(intensity(0) == doctest::Approx(1.465).epsilon(0.01));
  CHECK(intensity(4) == doctest::Approx(2.18).epsilon(0.01));
}

TEST_CASE("dielectric cylinders, packing fraction 0.027: covariance agrees with the exact solver") {
  SceneSpec spec = box();
  spec.scatterer = "tm";
  spec.radius = 1 / (2 * pi);
  spec.index = "1.5";
  spec.count = 67;
  spec.view_angles = {0.1, 0.4, 1.0, pi - 1, pi};
  const Scene scene = make_scene(spec);
  CHECK(scene.medium.cross_sections.scattering == doctest::Approx(0.30014).epsilon(1e-4));
  CHECK(scene.medium.g == doctest::Approx(0.3202).epsilon(1e-4));
  check_agreement(by_mc(scene, 500'000), by_wave(scene, 400), 0.08);
}

TEST_CASE("number of scatterers: a Poisson number has the forward lobe that a fixed number lacks") {
  SceneSpec spec = box();
  spec.view_angles = {0};
  spec.count = 31;
  const Scene fixed = make_scene(spec);
  spec.count.reset();
  spec.density = 31.0 / 200;
  const Scene poisson = make_scene(spec);
  const auto mc = by_mc(poisson, 500'000).covariance.value[0].real();
  CHECK(mc == doctest::Approx(2.099).epsilon(0.005));
  const auto with_poisson = by_wave(poisson, 10'000), with_fixed = by_wave(fixed, 10'000);
  CHECK(std::abs(with_poisson.covariance.value[0] - mc) <
        4 * with_poisson.covariance.error[0] + 0.03 * mc);
  CHECK(std::abs(with_fixed.covariance.value[0] - 0.90) <
        4 * with_fixed.covariance.error[0] + 0.03);

  // With a fixed number of scatterers N, the covariance lacks the fluctuation of the mean field m
  // that a Poisson number causes, N |dm/dN|^2. This is not |m|^2 / N, because m is not proportional
  // to N.
  constexpr double count = 31;
  const auto mean_of = [&](double number) {
    spec.density = number / 200;
    return mc::coherent_field(make_scene(spec))[0];
  };
  const double lost = count * std::norm((mean_of(count + 1) - mean_of(count - 1)) / 2.0);
  const double found =
      with_poisson.covariance.value[0].real() - with_fixed.covariance.value[0].real();
  const double error = std::hypot(with_poisson.covariance.error[0], with_fixed.covariance.error[0]);
  CHECK(std::abs(found - lost) < 4 * error + 0.05 * lost);
  CHECK(found + 4 * error < std::norm(mean_of(count)) / count);
}

TEST_CASE("coherent field: agrees with the exact mean field") {
  SceneSpec spec = box();
  spec.density = 31.0 / 200;
  spec.light_angles = {0, 0.4};
  spec.view_angles = {0, 0.05, 0.1, 0.4, 0.5, 3.0};
  const Scene scene = make_scene(spec);
  const auto mc = by_mc(scene, 1000), wave = by_wave(scene, 20'000);
  // Deviations are relative to the forward lobe, because the method neglects reflection and
  // diffraction at the edges of the box.
  const double lobe = std::abs(wave.mean.value[0]);
  for (std::size_t c = 0; c < wave.mean.value.size(); ++c) {
    CAPTURE(c);
    CHECK(std::abs(mc.mean.value[c] - wave.mean.value[c]) < 4 * wave.mean.error[c] + 0.03 * lobe);
  }
  CHECK(lobe > 5);
}

TEST_CASE("near sensors outside the box: covariance agrees with the exact solver") {
  SceneSpec spec = box_points();
  spec.covariance = "intensity";
  spec.tilts = {};
  Scene scene = make_scene(spec);
  scene.request = intensity_request({0}, {near_sensor({0, 14}), near_sensor({6, 12}),
                                          near_sensor({14, 5}), near_sensor({2, -3})});
  check_agreement(by_mc(scene, 300'000), by_wave(scene, 10'000), 0.03);
}

}  // namespace flatspeckle::test_wave_against_mc
