#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "grin/render/pictures/powers_within.h"
#include "grin/render/pictures/render_datasets.h"
#include "grin/render/transport/path_score.h"
#include "tests/grin/render_tests.h"

// Light that a method may miss: it is detected, or the run does not converge.

namespace flatspeckle::grin::tests::test_light_checks {

namespace {

constexpr double pi = std::numbers::pi;

RenderScene scene_in_box(double half, double height, const ScatteringMedium& medium,
                         const BeamLight& beam) {
  const Box box{{-half, -half, 0}, {half, half, height}};
  return {.field = Homogeneous{},
          .step = 1,
          .max_length = 1e3,
          .stage = {box, medium},
          .lights = {beam},
          .sensors = {}};
}

AreaDetector square(const Vec3& centre, double size) {
  return {centre, Vec3::UnitY(), size, size, {1, 1}, pi / 2};
}

/// Returns balls of index 1.5 in a row along a slightly narrower beam, between six detectors whose
/// sides are this fraction of those of the faces of the stage.
RenderScene balls_in_a_row(int balls, double share) {
  const double height = 4 + 2.2 * balls;
  RenderScene scene = scene_in_box(5, height, {}, {Vec3::Zero(), Vec3::UnitZ(), 0.9, 1});
  for (int i = 0; i < balls; ++i)
    scene.stage.bodies.push_back({Sphere{{0, 0, 3 + 2.2 * i}, 1}, {}, 0.5});
  const auto wall = [&](const Vec3& centre, const Vec3& up, double along) {
    return AreaDetector{centre, up, 10 * share, along * share, {1, 1}, pi / 2};
  };
  scene.sensors = {wall({0, 0, height}, Vec3::UnitY(), 10), wall(Vec3::Zero(), Vec3::UnitY(), 10)};
  for (const double sign : {-1., 1.}) {
    scene.sensors.emplace_back(wall({5 * sign, 0, height / 2}, Vec3::UnitZ(), height));
    scene.sensors.emplace_back(wall({0, 5 * sign, height / 2}, Vec3::UnitZ(), height));
  }
  return scene;
}

/// Checks that all light checks hold and, with full faces, that they detect all power.
void check_balls(int balls, double share, double samples) {
  CAPTURE(balls);
  CAPTURE(share);
  const RenderScene scene = balls_in_a_row(balls, share);
  const RenderJob job = render_job(scene, {}, 1);
  const RunState state = run_render(job, samples);
  double sum = 0, variance = 0;
  for (const SensorResult& result : render_result(scene, job, state.sums)) {
    sum += result.total->value[0].real();
    variance += std::pow(result.total->error[0], 2);
  }
  for (const LightCheck& check : light_checks(job, state.sums)) CHECK(check.holds());
  if (share == 1) CHECK(std::abs(sum - 1) < 4 * std::sqrt(variance));
  if (share == 1) CHECK(std::sqrt(variance) < 0.05);
}

/// Returns a thin beam in fog of optical depth 2, and a detector of all transmitted light.
RenderScene thin_beam(double radius) {
  RenderScene scene =
      scene_in_box(500, 2, {.mu_s = 0.9, .mu_a = 0.1}, {Vec3::Zero(), Vec3::UnitZ(), radius, 1});
  scene.sensors = {square({0, 0, 2}, 1000)};
  return scene;
}

}  // namespace

TEST_CASE("balls in a row under a beam: six faces detect all power") {
  for (const int balls : {1, 3, 6, 10}) check_balls(balls, 1, 4000);
}

TEST_CASE("balls in a row under a beam: light checks of small detectors hold") {
  for (const int balls : {2, 6}) check_balls(balls, 0.1, 8000);
}

TEST_CASE(
    "nightly: 1 to 50 balls in a row under a beam: light checks of detectors of all sizes hold") {
  for (const int balls : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 15, 20, 30, 40, 50})
    for (const double share : {1.0, 0.3, 0.1, 0.03}) check_balls(balls, share, 200000);
}

TEST_CASE("small detector in a wide beam: irradiance agrees with the closed form, by any method") {
  for (const double size : {1.0, 0.1, 1e-3, 1e-6})
    for (const RenderMethod method :
         {RenderMethod::light, RenderMethod::bidirectional, RenderMethod::forward}) {
      CAPTURE(size);
      CAPTURE(name(method));
      RenderScene scene = scene_in_box(2, 1, {.mu_a = 0.7}, {Vec3::Zero(), Vec3::UnitZ(), 1, 3});
      scene.sensors = {square({0.2, 0.1, 1}, size)};
      const Rendered found = rendered(scene, {method}, 4000);
      const double exact = 3 / pi * std::exp(-0.7);
      CHECK(std::abs(found.value() - exact) <= 4 * found.error() + 1e-9);
      CHECK(found.error() < 0.02 * exact);
    }
}

TEST_CASE("small detector at the edge of a Gaussian beam: irradiance agrees with the closed form") {
  RenderScene scene = scene_in_box(4, 1, {}, {Vec3::Zero(), Vec3::UnitZ(), 1, 1, Spread::gaussian});
  scene.sensors = {square({1.8, 0, 1}, 1e-3)};
  const Rendered found = rendered(scene, {RenderMethod::light}, 4000);
  CHECK(found.value() == doctest::Approx(2 / pi * std::exp(-2 * 1.8 * 1.8)).epsilon(1e-3));
}

TEST_CASE("thin beam in fog: path tracing, which misses it, does not converge") {
  for (const double radius : {1e-3, 1e-2}) {
    CAPTURE(radius);
    for (const RenderMethod method : {RenderMethod::path, RenderMethod::bidirectional}) {
      CAPTURE(name(method));
      const RenderScene scene = thin_beam(radius);
      const RenderJob job = render_job(scene, {method}, 1);
      const RunState state = run_render(job, 8000);
      const bool finds_it = method == RenderMethod::bidirectional;
      const LightCheck check = light_checks(job, state.sums)[0];
      CHECK(check.holds() == finds_it);
      CHECK(std::isfinite(job.batches.relative_error(state.sums)) == finds_it);
      const Estimate total = *render_result(scene, job, state.sums)[0].total;
      CHECK(std::abs(total.value[0].real() - 0.3564) < 4 * total.error[0]);
      CHECK((total.rare[0] != 0) == !finds_it);
    }
  }
}

TEST_CASE("powers on disks: each power reaches the target error, and dark disks do not") {
  PowersWithin powers{
      .radii = {1, 2}, .power = {{1e-4, 0.2}, {1e-5, 2e-3}, {0, 0}}, .covariance = {}};
  CHECK(largest_error(powers) == doctest::Approx(0.1));
  powers.power.rare = {1, 0};
  powers.power.error = {0.9e-5, 2e-3};
  CHECK(largest_error(powers) == doctest::Approx(0.09));
  powers.power.error = {1.1e-5, 2e-3};
  CHECK(std::isinf(largest_error(powers)));
  powers.power.value = {0, 0.2};
  powers.power.error = {0, 2e-3};
  CHECK(std::isinf(largest_error(powers)));
}

TEST_CASE("totals: as precise as the light paths that hit the sensor") {
  RenderScene scene = scene_in_box(2, 4, {}, {Vec3::Zero(), Vec3::UnitZ(), 0.5, 1});
  scene.lights = {PointLight{{0.2, 0, 0.4}}};
  scene.stage.bodies.push_back({Sphere{{0, 0, 2}, 1}, {}, 0.5});
  scene.sensors = {PolarDetector{Vec3::UnitZ(), pi, 12}};
  const RenderJob job = render_job(scene, {RenderMethod::light}, 1);
  const RunState state = run_render(job, 8000);
  const Estimate total = *render_result(scene, job, state.sums)[0].total;
  const Estimate plain = jackknife(state.sums, [&](double samples, std::span<const Complex> sums) {
    return std::vector{4 * pi * sums[job.first_of_checks()] / samples};
  });
  CHECK(plain.error[0] > 1e-3);
  CHECK(total.error[0] < 1e-6);
  CHECK(total.value[0].real() == doctest::Approx(1).epsilon(1e-6));
}

TEST_CASE("path scores by g: mean 0 for any width of the peak") {
  for (const double sign : {1., -1.})
    for (const double beside : {0.5, 1e-2, 1e-4, 1e-8, 1e-10, 1e-12}) {
      if (sign < 0 && beside < 1e-3) continue;  // sampled turns do not resolve angles near pi
      const double g = sign * (1 - beside);
      CAPTURE(g);
      const ScatteringMedium medium{.mu_s = 1, .phase = {HgPhase{g}}};
      RandomStream random(1, 1, 11);
      const Vec3 from = Vec3(1, 2, -3).normalized();
      constexpr int count = 40000;
      double sum = 0, square = 0;
      for (int i = 0; i < count; ++i) {
        PathScore score;
        score.turned(medium, from, medium.phase.sample(from, random));
        const double scaled = beside * score.by(MediumParameter::g, medium);
        sum += scaled / count;
        square += scaled * scaled / count;
      }
      CHECK(std::abs(sum) < 4 * std::sqrt(square / count));
      // the Fisher information of the peak, times beside^2, as beside -> 0 and at g = 1/2
      if (beside < 1e-3) CHECK(square == doctest::Approx(0.8).epsilon(0.05));
    }
}

}  // namespace flatspeckle::grin::tests::test_light_checks
