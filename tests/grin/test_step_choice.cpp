#include <cmath>

#include <doctest/doctest.h>

#include "grin/media/scattering/start_directions.h"
#include "grin/render/curved/ray_field.h"
#include "grin/render/values/step_choice.h"

namespace flatspeckle::grin::test_step_choice {

namespace {

template <IndexField F>
SceneField scene_of(const F& field) {
  return {facts(field), field};
}

struct Errors {
  double worst = 0, mean = 0;
};

/// Returns the errors of end points of rays relative to their lengths, against exact(start, sigma).
template <IndexField F, class Exact>
Errors end_errors(const F& field, const Surface& region, double step, double sigma,
                  const Exact& exact, bool leapfrogs = false) {
  constexpr int rays = 400;
  const auto steps = make_ray_field(field, {}, leapfrogs);
  const Box box = bounds(region);
  RandomStream random(5, 0, 0);
  Errors errors;
  for (int i = 0; i < rays;) {
    Vec3 share;
    for (const int axis : {2, 1, 0}) share[axis] = random.uniform();
    const Vec3 x = box.low + share.cwiseProduct(box.high - box.low);
    const Vec3 direction = random_turn(Vec3::UnitZ(), 2 * random.uniform(), random);
    if (distance(region, x) > 0) continue;
    const RayState start = start_ray(*steps, x, direction);
    const Vec3 end = exact(start, sigma);
    if (!end.allFinite() || distance(region, end) > 0) continue;
    RayState ray = start;
    steps->advance(sigma, static_cast<int>(std::ceil(sigma / step)), ray, nullptr);
    const double error = (ray.x - end).norm() / ray.arc_length;
    errors.worst = std::max(errors.worst, error);
    errors.mean += error / rays;
    ++i;
  }
  return errors;
}

/// Checks the errors at the chosen step; three times the step is too coarse.
template <class Measure>
void check_tolerance(const Measure& errors, double step) {
  const Errors at = errors(step), coarse = errors(3 * step);
  CHECK(at.worst < 2 * step_tolerance);
  CHECK(at.mean < step_tolerance / 3);
  CHECK(coarse.worst > 2 * step_tolerance);
}

/// Returns end points by steps far below the chosen ones.
template <IndexField F>
auto fine(const F& field, double step) {
  return [&field, step](RayState ray, double sigma) {
    const int steps = static_cast<int>(std::ceil(sigma / step));
    for (int i = 0; i < steps; ++i) Sharma::step(field, ray, sigma / steps);
    return ray.x;
  };
}

}  // namespace

TEST_CASE("chosen step: errors from closed forms are within its tolerance") {
  const Sphere ball{Vec3::Zero(), 1};
  const Luneburg luneburg({1, LuneburgProfile::for_stops});
  const auto ellipse = [](const RayState& ray, double sigma) -> Vec3 {
    return std::cos(sigma) * ray.x + std::sin(sigma) * ray.v;
  };
  check_tolerance([&](double step) { return end_errors(luneburg, ball, step, 1, ellipse); },
                  chosen_step(scene_of(luneburg), {.boundary = ball}, false));

  const Box fibre{{-0.9, -0.9, 0}, {0.9, 0.9, 50}};
  const double alpha = 0.5;
  const ParabolicGuide guide({0.6, alpha});
  const auto sinusoid = [&](const RayState& ray, double sigma) -> Vec3 {
    const double c = std::cos(alpha * sigma), s = std::sin(alpha * sigma) / alpha;
    return {c * ray.x[0] + s * ray.v[0], c * ray.x[1] + s * ray.v[1], ray.x[2] + sigma * ray.v[2]};
  };
  check_tolerance([&](double step) { return end_errors(guide, fibre, step, 20, sinusoid); },
                  chosen_step(scene_of(guide), {.boundary = fibre}, false));
}

TEST_CASE(
    "chosen step in sound and narrow ramps: errors from fine steps are within its tolerance") {
  const Box tank{{-5, -5, 0}, {5, 5, 10}};
  const StandingWave strong(0.33, 0.02, 0, 8.4, 10);
  check_tolerance(
      [&](double step) { return end_errors(strong, tank, step, 5, fine(strong, 0.01)); },
      chosen_step(scene_of(strong), {.boundary = tank}, false));

  const Box cube{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
  const TanhRamp ramp{0, 0.33, 0.01, Vec3::UnitZ(), {7, 0, 0.1}};
  const double step = chosen_step(scene_of(ramp), {.boundary = cube}, false);
  const Errors at = end_errors(ramp, cube, step, 0.3, fine(ramp, 1e-4));
  CHECK(at.worst < 2 * step_tolerance);
  CHECK(at.mean < step_tolerance / 3);
}

TEST_CASE("chosen step in weak sound: leapfrog, within the same tolerance") {
  const Box tank{{-15, -15, 0}, {15, 15, 30}};
  const StandingWave weak(0.33, 1e-3, 0, 3.4, 22);
  const StepChoice chosen = chosen_steps(scene_of(weak), {.boundary = tank}, false);
  REQUIRE(chosen.leapfrogs);
  check_tolerance(
      [&](double step) { return end_errors(weak, tank, step, 15, fine(weak, 0.05), true); },
      chosen.step);

  const StandingWave strong(0.33, 0.1, 0, 8.4, 10);
  CHECK(
      !chosen_steps(scene_of(strong), {.boundary = Box{{-5, -5, 0}, {5, 5, 10}}}, false).leapfrogs);
  const Sphere ball{Vec3::Zero(), 1};
  const Fisheye fisheye({1.6, 1});
  const StepChoice of_fisheye = chosen_steps(scene_of(fisheye), {.boundary = ball}, false);
  CHECK(!of_fisheye.leapfrogs);
  CHECK(of_fisheye.step == chosen_step(scene_of(fisheye), {.boundary = ball}, false));
}

TEST_CASE("chosen step: decreases with the strength of a field") {
  const Box tank{{-5, -5, 0}, {5, 5, 10}};
  const auto step = [&](double amplitude, bool any_phase = false) {
    return chosen_step(scene_of(StandingWave(0.33, amplitude, 0, 8.4, 10)), {.boundary = tank},
                       any_phase);
  };
  const double scale = 1 / 8.4, size = std::sqrt(300.);
  CHECK(step(1e-12) == doctest::Approx(size));
  CHECK(step(1e-3) == doctest::Approx(3 * scale).epsilon(0.05));
  CHECK(step(1e-2) < 2 * scale);
  CHECK(step(0.1) < step(1e-2));
  CHECK(step(0.1) > scale / 10);
  CHECK(step(0.02, true) <= step(0.02));
  CHECK(step(1e-2) == step(1e-2));
}

TEST_CASE("chosen step: proportional to the unit of length") {
  const auto step = [](double unit) {
    const Sphere ball{Vec3::Zero(), unit};
    return chosen_step(scene_of(Fisheye({1.6, unit})), {.boundary = ball}, false) / unit;
  };
  CHECK(step(1e-6) == doctest::Approx(step(1)).epsilon(0.03));
  CHECK(step(1e6) == doctest::Approx(step(1)).epsilon(0.03));
}

TEST_CASE("chosen step: resolves a narrow blob in a wide stage") {
  const Box wide{{-50, -50, -50}, {50, 50, 50}};
  const GaussianBlobs blobs({{{3, -7, 11}, 0.2, 0.3}});
  const double step = chosen_step(scene_of(blobs), {.boundary = wide}, false);
  RayState ray = start_ray(blobs, {2.7, -7, 0}, Vec3::UnitZ()), exact = ray;
  const double sigma = 30;
  for (int i = 0; i < std::ceil(sigma / step); ++i)
    Sharma::step(blobs, ray, sigma / std::ceil(sigma / step));
  for (int i = 0; i < 30000; ++i) Sharma::step(blobs, exact, sigma / 30000);
  CHECK(exact.v[0] > 0.05);
  CHECK((ray.x - exact.x).norm() < 2 * step_tolerance * ray.arc_length);
}

}  // namespace flatspeckle::grin::test_step_choice
