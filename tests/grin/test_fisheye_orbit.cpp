#include <algorithm>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "bench/scenes/random_fields.h"
#include "grin/rays/connections/connection_trial.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/rays/marching/ray_step.h"
#include "grin/render/curved/fisheye_rays.h"
#include "grin/render/curved/ray_field.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_fisheye_orbit {

using bench::random_direction;
using bench::random_point;
using flatspeckle::tests::is_night;

namespace {

const Vec3 centre(0.3, -0.2, 0.5);
constexpr double radius = 1.7, wide = 2.1;  // radii of the fisheye and of the sphere where rays end
const Fisheye fisheye({1.6, radius}, centre);
const Surface rim = Sphere{centre, wide};
constexpr double inside = 1;

/// A ray by steps so small that it is exact to 1e-11.
struct Stepped {
  RayState ray;
  RayTangent tangent = {};
  void go(double sigma) {
    constexpr int steps = 4000;
    for (int i = 0; i < steps; ++i) Sharma::step(fisheye, ray, tangent, sigma / steps);
  }
};

CurveEndpoints endpoints(const Vec3& from, const Vec3& to) {
  return {from, to, {{&rim, 1}, {&inside, 1}}};
}

}  // namespace

TEST_CASE("fisheye rays in closed form: agree with small steps") {
  RandomStream random(3, 1, 0);
  for (int i = 0; i < 60; ++i) {
    const Vec3 x = wide / radius * random_point(random, 1);
    Vec3 w = random_direction(random);
    if (i % 5 == 0) w = (x + 1e-5 * i * w).normalized();  // nearly straight
    Stepped exact{start_ray(fisheye, centre + radius * x, w)};
    exact.go(radius * 0.4 * random.uniform());
    const auto place = FisheyeOrbit(x, w).at(exact.ray.arc_length / radius);
    CHECK((centre + radius * place.x - exact.ray.x).norm() < 1e-9);
    CHECK((place.w - exact.ray.v.normalized()).norm() < 1e-9);
    CHECK(radius * 1.3 * place.angle == doctest::Approx(exact.ray.optical_path).epsilon(1e-9));
  }
}

TEST_CASE("fisheye rays in closed form: periodic on a circle, with increasing angle and sigma") {
  const FisheyeOrbit orbit(Vec3(0.3, 0, 0.1), Vec3(0, 0.6, 0.8));
  const double around = orbit.circumference();
  const auto once = orbit.at(0.3 * around), again = orbit.at(2.3 * around);
  CHECK((once.x - again.x).norm() < 1e-12);
  CHECK((once.w - again.w).norm() < 1e-12);
  CHECK(again.angle == doctest::Approx(once.angle + 4 * std::numbers::pi));
  CHECK(again.sigma > once.sigma);
}

TEST_CASE("fisheye rays in closed form: end on a sphere, or stay inside") {
  RandomStream random(4, 1, 0);
  int kept = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = random_point(random, 1);
    const Vec3 w = i % 7 == 0 ? x.normalized() : random_direction(random);
    const double end = x.norm() + 0.7 * random.uniform();
    const FisheyeOrbit orbit(x, w);
    const double s = orbit.exit_distance(end);
    REQUIRE(s >= 0);
    const double far = std::isfinite(s) ? s : orbit.circumference();
    kept += !std::isfinite(s);
    for (const double part : {0.1, 0.5, 0.9, 0.999})
      CHECK(orbit.at(part * far).x.norm() < end * (1 + 1e-12));
    if (!std::isfinite(s)) continue;
    const auto last = orbit.at(s);
    CHECK(last.x.norm() == doctest::Approx(end).epsilon(1e-10));
    CHECK(last.x.dot(last.w) > -1e-10);
  }
  CHECK(kept > 100);
}

TEST_CASE("fisheye flights in closed form: rays and spreading agree with small steps") {
  const auto closed = make_ray_field(fisheye, {&rim, 1});
  static const PartMedium clear;
  RandomStream random(5, 1, 0);
  for (int i = 0; i < 40; ++i) {
    const Vec3 x = centre + 0.9 * wide * random_point(random, 1);
    RayState ray = start_ray(fisheye, x, random_direction(random));
    RayTangent tangent;
    Stepped exact{ray};
    double weight = 1;
    const SegmentDomain domain{SurfaceRegion{{&rim, 1}}, clear, 0.05};
    const double n = ray.v.norm();
    const Vec3 first = ray.v.normalized();
    if (closed->fly(domain, 100, weight, random, ray, &tangent) != SegmentStop::surface) continue;
    CHECK((ray.x - centre).norm() == doctest::Approx(wide).epsilon(1e-9));
    // sigma by bisection: equal steps of sigma reach the arc length of the ray
    double low = 0, high = 100;
    for (int k = 0; k < 50; ++k) {
      Stepped tried{exact.ray};
      for (int step = 0; step < 400; ++step) Sharma::step(fisheye, tried.ray, (low + high) / 800);
      (tried.ray.arc_length < ray.arc_length ? low : high) = (low + high) / 2;
    }
    exact.go((low + high) / 2);
    CHECK((exact.ray.x - ray.x).norm() < 1e-6);
    CHECK((exact.ray.v - ray.v).norm() < 1e-6);
    CHECK(signed_spreading(tangent, n, first, ray.v.normalized()) ==
          doctest::Approx(signed_spreading(exact.tangent, n, first, exact.ray.v.normalized()))
              .epsilon(1e-5));
  }
}

TEST_CASE("fisheye connections in closed form: agree with the general solver") {
  const auto closed = make_ray_field(fisheye, {&rim, 1});
  ConnectionStatistics statistics;
  RandomStream random(6, 1, 0);
  const ConnectionOptions options{.step = 0.02, .max_length = 40};
  int compared = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 from = centre + 0.9 * wide * random_point(random, 1);
    const Vec3 to = i % 4 == 0 ? Vec3(from + 1e-3 * random_point(random, 1))
                               : Vec3(centre + 0.9 * wide * random_point(random, 1));
    const ConnectionTrial trial(fisheye, endpoints(from, to).region, from, to, options);
    const auto by_steps = trial.along_chord(statistics);
    if (by_steps.outcome != TrialOutcome::converged) continue;
    for (int draw = 0; draw < 40; ++draw) {
      const auto found = closed->connect(endpoints(from, to), options, random, statistics);
      if (!found.curve || std::abs(found.curve->sigma - by_steps.curve.sigma) > 1e-4) continue;
      ++compared;
      CHECK((found.curve->start_direction - by_steps.curve.start_direction).norm() < 1e-6);
      CHECK((found.curve->end_direction - by_steps.curve.end_direction).norm() < 1e-6);
      CHECK(found.curve->arc_length == doctest::Approx(by_steps.curve.arc_length).epsilon(1e-7));
      CHECK(found.curve->optical_path ==
            doctest::Approx(by_steps.curve.optical_path).epsilon(1e-7));
      CHECK(found.curve->spreading == doctest::Approx(by_steps.curve.spreading).epsilon(1e-5));
      CHECK(found.curve->orientation == by_steps.curve.orientation);
      break;
    }
  }
  CHECK(compared > 60);
}

TEST_CASE(
    "fisheye connections in closed form: means by multiplicity agree with sums over all curves") {
  // sums of exp(-arc length) over the curves: a circle inside, one cut by the rim, and one whose
  // longer arc alone is inside
  const auto closed = make_ray_field(fisheye, {&rim, 1});
  RandomStream random(7, 1, 0);
  ConnectionStatistics statistics;
  const ConnectionOptions options{.step = 0.02, .max_length = 60};
  const auto at = [](double x, double y, double z) {
    return Vec3(centre + radius * Vec3(x, y, z));
  };
  const std::pair<Vec3, Vec3> pairs[] = {{at(0.9, 0, 0), at(0, 0.9, 0.2)},
                                         {at(0.2, 0.1, 0), at(-0.3, 0.1, 0.4)},
                                         {at(1.1, 0.4, 0), at(1.1, -0.4, 0)}};
  for (const auto& [from, to] : pairs) {
    double sum = 0, square = 0;
    const int draws = is_night ? 20000 : 8000;
    for (int i = 0; i < draws; ++i) {
      const auto found = closed->connect(endpoints(from, to), options, random, statistics);
      const double value =
          found.curve ? found.multiplicity * std::exp(-found.curve->arc_length) : 0;
      sum += value / draws;
      square += value * value / draws;
    }
    double expected = 0;
    const auto all = closed->connections(endpoints(from, to), options, 3000, random, statistics);
    for (const auto& found : all) expected += std::exp(-found.curve.arc_length);
    CAPTURE(all.size());
    CHECK(std::abs(sum - expected) <
          4 * std::sqrt(std::max(square - sum * sum, 0.0) / draws) + 1e-3 * expected);
  }
}

}  // namespace flatspeckle::grin::test_fisheye_orbit
