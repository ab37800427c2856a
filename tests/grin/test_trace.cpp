#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "grin/media/fields/fisheye.h"
#include "grin/media/fields/gaussian_blobs.h"
#include "grin/media/fields/linear_ramp.h"
#include "grin/media/fields/parabolic.h"
#include "grin/media/fields/sech.h"
#include "grin/media/fields/tanh_ramp.h"
#include "grin/rays/marching/ray_invariants.h"
#include "grin/rays/marching/trace.h"
#include "grin/rays/surfaces/interface.h"
#include "tests/grin/ray_tests.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_trace {

using tests::pi;

namespace {

const Luneburg lens{LuneburgProfile{1, 0.3}};
const TraceLimits far{1e3, 1e-11};

template <class Integrator>
ControlledSteps<Integrator> controlled(double tolerance, double longest = 1) {
  return {tolerance, 0.01, longest};
}

/// A Luneburg lens whose gradient is too large by the fraction `wrong`.
struct WrongGradient {
  double wrong;

  double excess(const Vec3& x) const { return lens.excess(x); }
  IndexGradient gradient(const Vec3& x) const {
    const IndexGradient at = lens.gradient(x);
    return {at.excess, (1 + wrong) * at.gradient};
  }
  IndexHessian hessian(const Vec3& x) const { return lens.hessian(x); }
};

}  // namespace

TEST_CASE("trace: straight rays stop at spheres, planes and boxes") {
  const Homogeneous plain{0.5};
  FixedSteps<Leapfrog> steps{0.1};
  const std::vector<Surface> surfaces{Sphere{{0, 0, 5}, 1}, Plane{{0, 0, 20}, Vec3::UnitZ()},
                                      Box{{-1, 9, -1}, {1, 11, 1}}};
  RayState up = start_ray(plain, {0.6, 0, 0}, Vec3::UnitZ());
  const TraceEnd first = trace(plain, surfaces, far, steps, up);
  CHECK(first.stop == Stop::surface);
  CHECK(first.surface == 0);
  CHECK(std::abs(up.x[2] - 4.2) < 1e-11);
  CHECK(up.optical_path == doctest::Approx(1.5 * 4.2));
  CHECK(trace(plain, surfaces, far, steps, up).surface == 0);  // out again on the other side
  CHECK(std::abs(up.x[2] - 5.8) < 1e-10);
  CHECK(trace(plain, surfaces, far, steps, up).surface == 1);
  CHECK(std::abs(up.x[2] - 20) < 1e-10);
  RayState aside = start_ray(plain, {0.5, 0, 0.25}, {0, 1, 0.01});
  CHECK(trace(plain, surfaces, far, steps, aside).surface == 2);
  CHECK(std::abs(aside.x[1] - 9) < 1e-11);
  CHECK(normal(surfaces[2], aside.x) == Vec3(0, -1, 0));
  RayState away = start_ray(plain, {0.5, 0, 0}, -Vec3::UnitX());
  const TraceEnd none = trace(plain, surfaces, far, steps, away);
  CHECK(none.stop == Stop::length);
  CHECK(away.arc_length == doctest::Approx(1e3).epsilon(1e-13));
  CHECK_THROWS_AS(trace(plain, std::vector<Surface>(65), far, steps, up), InputError);
}

TEST_CASE("box: distance and normal agree with the closed form") {
  const Box box{{-1, -2, -3}, {1, 2, 3}};
  CHECK(box.distance({0, 0, 0}) == -1);
  CHECK(box.distance({0.5, 1.8, 0}) == doctest::Approx(-0.2));
  CHECK(box.distance({4, 6, 0}) == 5);
  CHECK(box.distance({0, 0, -5}) == 2);
  CHECK(box.normal({0.3, 0.1, -3}) == Vec3(0, 0, -1));
}

TEST_CASE_TEMPLATE("trace through a Luneburg lens in air: agrees with its focus", I, Leapfrog,
                   Yoshida4, Sharma) {
  const std::vector<Surface> rim{Sphere{}};
  auto steps = controlled<I>(I::order == 2 ? 1e-7 : 1e-12);
  FixedSteps<Leapfrog> none{1};
  const double tolerance = I::order == 2 ? 1e-5 : 1e-10;
  for (const double height : {0.0, 0.2, 0.7, 0.99}) {
    RayState ray = start_ray(Homogeneous{}, {-1, height, 0}, Vec3::UnitX());
    if (height > 0) CHECK(trace(Homogeneous{}, rim, far, none, ray).stop == Stop::surface);
    CHECK(std::abs(ray.x.norm() - 1) < 1e-11);
    CHECK(trace(lens, rim, far, steps, ray).surface == 0);
    CHECK(std::abs(ray.x.norm() - 1) < 1e-11);
    CHECK((ray.x - Vec3::UnitX()).norm() < tolerance);
    CHECK(std::abs(ray.optical_path - (pi / 2 + 1)) < tolerance);
  }
}

TEST_CASE("controlled steps: errors follow the tolerance") {
  const tests::LuneburgRay exact{{-0.6, 0.3, 0.2}, start_ray(lens, {-0.6, 0.3, 0.2}, {1, 1, 0}).v};
  const auto speed = [&](double s) { return index(lens, exact.x(s)); };
  double sigma = 1;  // where the arc is 1
  for (int i = 0; i < 10; ++i)
    sigma -= (flatspeckle::tests::integral(speed, 0, sigma) - 1) / speed(sigma);
  long before = 0;
  for (const double tolerance : {1e-5, 1e-7, 1e-9, 1e-11}) {
    auto steps = controlled<Sharma>(tolerance);
    RayState ray{exact.x0, exact.v0};
    const TraceEnd end = trace(lens, std::vector<Surface>{}, {1, 1e-12}, steps, ray);
    CHECK(end.stop == Stop::length);
    CHECK(std::abs(ray.arc_length - 1) < 1e-12);
    CHECK((ray.x - exact.x(sigma)).norm() < 2 * tolerance);
    CHECK(end.steps > before);
    before = end.steps;
    CHECK(std::abs(ray_invariants(lens, ray).index_mismatch) < 4 * tolerance);
  }
}

TEST_CASE("controlled steps: report the deviation from |v| = n before they correct it") {
  constexpr double tolerance = 1e-9;
  for (const double wrong : {0.0, 0.01}) {
    const WrongGradient field{wrong};
    auto steps = controlled<Sharma>(tolerance);
    RayState ray = start_ray(field, {-0.6, 0.3, 0.2}, {1, 1, 0});
    trace(field, std::vector<Surface>{}, {1, 1e-12}, steps, ray);
    CHECK(std::abs(ray_invariants(field, ray).index_mismatch) < tolerance);
    if (wrong == 0)
      CHECK(steps.index_mismatch < 10 * tolerance);
    else
      CHECK(steps.index_mismatch > 1e4 * tolerance);
  }
}

TEST_CASE("controlled steps far from the origin: rounding is not counted as an error") {
  const ParabolicGuide guide(ParabolicProfile{0.5, 1});
  for (const double start : {1e3, 1e6, 1e8}) {
    CAPTURE(start);
    const std::vector<Surface> end{Plane{{0, 0, start + 10}, Vec3::UnitZ()}};
    auto steps = controlled<Sharma>(1e-11);
    RayState ray = start_ray(guide, {0, 0, start}, {0.2, 0, 1});
    const Vec3 v0 = ray.v;
    CHECK(trace(guide, end, {20, 1e-14 * start}, steps, ray).surface == 0);
    const double sigma = 10 / v0[2];
    CHECK(std::abs(ray.x[0] - v0[0] * std::sin(sigma)) < 1e-9 + 1e-14 * start);
  }
}

TEST_CASE("controlled steps: at most the longest step, at any index") {
  for (const double background : {0.0, 99.0}) {
    CAPTURE(background);
    const double height = 0.1 * (1 + background);
    const GaussianBlobs blob({{{0.05, 0, 50}, height, 0.1}}, background);
    RayState ray = start_ray(blob, {0, 0, 0}, Vec3::UnitZ()), exact = ray;
    auto steps = controlled<Sharma>(1e-9, 0.1);
    FixedSteps<Sharma> fine{1e-3 / (1 + background)};
    trace(blob, std::vector<Surface>{}, {100, 1e-9}, steps, ray);
    trace(blob, std::vector<Surface>{}, {100, 1e-9}, fine, exact);
    CHECK((ray.x - exact.x).norm() < 1e-6);
    CHECK(std::abs(ray.x[0]) > 1);
  }
}

TEST_CASE(
    "trace in a fisheye: agrees with the image point, also through regions where n is nearly 0") {
  const Fisheye eye(FisheyeProfile{0.5, 1});
  auto steps = controlled<Sharma>(1e-12, 1e9);
  const Vec3 start = Vec3(1, 2, 2) / 3, across = Vec3(2, 1, -2) / 3;
  for (const double angle : {1.2, 0.3, 0.02, 0.002}) {
    // A circle of radius 1/sin(angle) through the start and its image; n is about sin^2(angle)/4
    // of n0 at its far end.
    RayState ray = start_ray(eye, start, std::cos(angle) * start + std::sin(angle) * across);
    const double arc = 2 * (pi - angle) / std::sin(angle);
    const RayInvariants first = ray_invariants(eye, ray);
    const TraceEnd end = trace(eye, std::vector<Surface>{}, {arc, 1e-11 * arc}, steps, ray);
    CAPTURE(angle);
    CAPTURE(end.steps);
    CHECK(end.stop == Stop::length);
    CHECK((ray.x + start).norm() < 1e-9 / angle);
    CHECK(std::abs(ray.optical_path - pi * 1.5 / 2) < 1e-9 / angle);
    CHECK((ray_invariants(eye, ray).angular_momentum - first.angular_momentum).norm() < 1e-10);
    CHECK(std::abs(ray_invariants(eye, ray).index_mismatch) < 1e-10);
  }
}

TEST_CASE("modal dispersion in guides: none in sech, agrees with C27 in the parabolic one") {
  const double n0 = 1.5, alpha = 0.6;
  const SechGuide sech(SechProfile{n0 - 1, alpha});
  const ParabolicGuide parabolic(ParabolicProfile{n0 - 1, alpha});
  auto steps = controlled<Yoshida4>(1e-12);
  for (const double tangent : {0.0, 0.05, 0.3, 0.8}) {
    const Vec3 direction(tangent * 0.6, tangent * 0.8, 1);
    for (const bool quadratic : {false, true}) {
      CAPTURE(tangent);
      CAPTURE(quadratic);
      RayState ray = start_ray(Homogeneous{n0 - 1}, Vec3::Zero(), direction);
      const double beta = ray.v[2];
      // Five half periods.
      const double length = 5 * pi / alpha * (quadratic ? beta : 1);
      const std::vector<Surface> end{Plane{{0, 0, length}, Vec3::UnitZ()}};
      const TraceEnd stop = quadratic ? trace(parabolic, end, {1e3, 1e-11}, steps, ray)
                                      : trace(sech, end, {1e3, 1e-11}, steps, ray);
      CHECK(stop.stop == Stop::surface);
      CHECK(std::hypot(ray.x[0], ray.x[1]) < 1e-9);
      const double per_length = quadratic ? (n0 * n0 + beta * beta) / (2 * beta) : n0;
      CHECK(std::abs(ray.optical_path / length - per_length) < 1e-9);
    }
  }
}

TEST_CASE("trace in a steep ramp: reflects rays beyond Snell's critical angle, and only those") {
  const double n1 = 1.5, n2 = 1.2;
  for (const double width : {0.1, 1e-3}) {
    const TanhRamp ramp{n1 - 1, n2 - 1, width};
    const std::vector<Surface> ends{Plane{{0, 0, -20 * width}, -Vec3::UnitZ()},
                                    Plane{{0, 0, 20 * width}, Vec3::UnitZ()}};
    const TraceLimits limits{1e6 * width, 1e-9 * width, 500'000};
    auto steps = controlled<Sharma>(1e-11, width);
    const auto passes = [&](double sine) {
      RayState ray = start_ray(ramp, {0, 0, -19 * width}, {sine, 0, std::sqrt(1 - sine * sine)});
      const TraceEnd end = trace(ramp, ends, limits, steps, ray);
      CHECK(end.stop == Stop::surface);
      return end.surface == 1;
    };
    const double critical = n2 / n1;
    CHECK(passes(critical * (1 - 1e-8)));
    CHECK(!passes(critical * (1 + 1e-8)));
    RayState ray = start_ray(ramp, {0, 0, -19 * width}, {0.5, 0, std::sqrt(0.75)});
    trace(ramp, ends, limits, steps, ray);
    CHECK(ray.v[0] / ray.v.norm() == doctest::Approx(0.5 * n1 / n2).epsilon(1e-8));
  }
}

TEST_CASE("trace: a step that crosses a surface twice ends at the first crossing") {
  const ParabolicGuide guide(ParabolicProfile{0.5, 1});
  const RayState start = start_ray(guide, {0, 0, 0}, {0.3, 0, 1});
  // The turn at sigma = pi/2 is in the middle of a step, at whose ends x is 3e-3 lower.
  const double amplitude = start.v[0], step = 2 * pi / 38;
  for (const double depth : {0.1, 1e-2, 1e-3, 1e-4}) {
    const std::vector<Surface> wall{Plane{{amplitude * (1 - depth), 0, 0}, Vec3::UnitX()}};
    FixedSteps<Yoshida4> steps{step};
    RayState ray = start;
    CHECK(trace(guide, wall, far, steps, ray).surface == 0);
    const double sigma = std::asin(1 - depth);
    CHECK(std::abs(ray.x[0] - amplitude * (1 - depth)) < 1e-11);
    CHECK(ray.x[2] == doctest::Approx(start.v[2] * sigma).epsilon(1e-4 / std::sqrt(depth)));
  }
  const std::vector<Surface> beyond{Plane{{amplitude * 1.001, 0, 0}, Vec3::UnitX()}};
  FixedSteps<Yoshida4> steps{step};
  RayState ray = start;
  CHECK(trace(guide, beyond, {100, 1e-11}, steps, ray).stop == Stop::length);
}

TEST_CASE("trace: a step through two surfaces ends at the first") {
  const ParabolicGuide guide(ParabolicProfile{0.5, 1});
  const std::vector<Surface> plate_and_plane{Plane{{0, 0, 0.42}, Vec3::UnitZ()},
                                             Box{{-1, -1, 0.32}, {1, 1, 0.33}}};
  FixedSteps<Leapfrog> steps{0.1};  // 0.15 long
  RayState ray = start_ray(guide, {0, 0, 0}, Vec3::UnitZ());
  for (const auto& [surface, z] : {std::pair(1, 0.32), std::pair(1, 0.33), std::pair(0, 0.42)}) {
    CHECK(trace(guide, plate_and_plane, far, steps, ray).surface == surface);
    CHECK(std::abs(ray.x[2] - z) < 1e-11);
  }
}

TEST_CASE("trace: distances to far surfaces are rarely evaluated") {
  const ParabolicGuide guide(ParabolicProfile{0.5, 1});
  const std::vector<Surface> far_wall{Plane{{0, 0, 1000}, Vec3::UnitZ()}};
  FixedSteps<Leapfrog> steps{0.1};
  RayState ray = start_ray(guide, {0.3, 0, 0}, {0.1, 0, 1});
  const TraceEnd end = trace(guide, far_wall, {1e4, 1e-9}, steps, ray);
  CHECK(end.stop == Stop::surface);
  CHECK(end.steps > 6000);
  CHECK(end.distance_evaluations < 100);
}

TEST_CASE("trace: straight rays run beside a face at any distance, and along it") {
  const std::vector<Surface> faces{Plane{{0, 0, 1}, Vec3::UnitZ()}, Box{{-2, -2, -2}, {2, 2, 1}}};
  FixedSteps<Leapfrog> steps{1};
  for (const double off : {0.0, 1e-12, 1e-7, 1e-3}) {
    RayState ray{{0, 0, 1 - off}, Vec3::UnitX()};
    const TraceEnd end = trace(Homogeneous{}, faces, {100, 1e-9}, steps, ray);
    CHECK(end.surface == (off < 1e-9 ? -1 : 1));
    CHECK(ray.x[0] == doctest::Approx(off < 1e-9 ? 100 : 2));
  }
}

TEST_CASE("trace: rays are lost where the index is not defined") {
  const LinearRamp ramp{0, {0, 0, -1}};  // n = 1 - z
  FixedSteps<Leapfrog> fixed{0.05};
  // A long step jumps over z = 1, where n = 0; with controlled steps the ray approaches it and
  // never arrives.
  RayState ray = start_ray(ramp, {0, 0, 0.99}, Vec3::UnitZ());
  fixed.h = 10;
  CHECK(trace(ramp, std::vector<Surface>{}, far, fixed, ray).stop == Stop::lost);
  auto careful = controlled<Sharma>(1e-10);
  RayState creeping = start_ray(ramp, {0, 0, 0}, Vec3::UnitZ());
  CHECK(trace(ramp, std::vector<Surface>{}, far, careful, creeping).stop == Stop::lost);
  const ParabolicGuide guide(ParabolicProfile{0.5, 1});  // no index beyond rho = 1.5
  FixedSteps<Sharma> wide{2};
  RayState out{{1, 0, 0}, {3, 0, 1}};
  CHECK(trace(guide, std::vector<Surface>{}, far, wide, out).stop == Stop::lost);
  // A wall before that point still stops the ray.
  const std::vector<Surface> wall{Plane{{1.2, 0, 0}, Vec3::UnitX()}};
  RayState stopped{{1, 0, 0}, {3, 0, 1}};
  CHECK(trace(guide, wall, far, wide, stopped).surface == 0);
  CHECK(std::abs(stopped.x[0] - 1.2) < 1e-11);
}

}  // namespace flatspeckle::grin::test_trace
