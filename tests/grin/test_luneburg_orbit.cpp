#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "bench/scenes/random_fields.h"
#include "grin/rays/connections/connection_trial.h"
#include "grin/render/curved/luneburg_rays.h"
#include "grin/render/curved/ray_field.h"
#include "tests/grin/ray_tests.h"

namespace flatspeckle::grin::test_luneburg_orbit {

using bench::random_direction;
using bench::random_point;

namespace {

const Vec3 centre(0.3, -0.2, 0.5);
constexpr double radius = 2.5;
const Luneburg lens({radius, LuneburgProfile::for_stops}, centre);
const Surface rim = Sphere{centre, radius};

struct Both {
  RayState ray;
  RayTangent tangent = {};
};

/// Returns the ray and its tangent after steps so small that only rounding is left.
Both stepped(Both from, double sigma) {
  constexpr int steps = 4000;
  for (int i = 0; i < steps; ++i) Sharma::step(lens, from.ray, from.tangent, sigma / steps);
  return from;
}

void check_same(const Both& a, const Both& b, double tolerance) {
  CHECK((a.ray.x - b.ray.x).norm() < tolerance);
  CHECK((a.ray.v - b.ray.v).norm() < tolerance);
  CHECK(std::abs(a.ray.arc_length - b.ray.arc_length) < 1e-8 * radius);
  CHECK(std::abs(a.ray.optical_path - b.ray.optical_path) < tolerance);
  CHECK((a.tangent.dx - b.tangent.dx).norm() < tolerance);
  CHECK((a.tangent.dv - b.tangent.dv).norm() < tolerance);
}

}  // namespace

TEST_CASE("Luneburg rays in closed form: rays and tangents agree with small steps") {
  const auto rays = make_ray_field(lens, {&rim, 1});
  RandomStream random(3, 1, 0);
  for (int i = 0; i < 100; ++i) {
    Both start{
        start_ray(lens, centre + radius * random_point(random, 1), random_direction(random))};
    start.tangent.dx.setRandom();
    const double sigma = 4 * radius * random.uniform();  // ellipses extend beyond the rim
    Both found = start;
    rays->advance(sigma, 7, found.ray, &found.tangent);
    if ((found.ray.x - centre).norm() > radius || sigma > radius) continue;
    check_same(found, stepped(start, sigma), 1e-10);
  }
}

TEST_CASE(
    "Luneburg rays in closed form: exits from inner spheres and index agree with the ellipse") {
  RandomStream random(4, 1, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 x = random_point(random, 1);
    const Vec3 v = std::sqrt(2 - x.squaredNorm()) * random_direction(random);
    const tests::LuneburgRay exact{x, v};
    const double end = x.norm() + (1 - x.norm()) * random.uniform();
    const LuneburgOrbit orbit(x, v);
    const double t = orbit.exit_distance(end);
    REQUIRE(t >= 0);
    CHECK(t <= std::numbers::pi / 2);
    CHECK(exact.x(t).norm() == doctest::Approx(end).epsilon(1e-12));
    CHECK(exact.x(t).dot(exact.v(t)) >= -1e-12);
    for (const double part : {0.2, 0.7}) {
      const double c = std::cos(part * t), s = std::sin(part * t);
      CHECK(exact.x(part * t).norm() <= end * (1 + 1e-12));
      CHECK(orbit.squared_index(c, s) == doctest::Approx(exact.v(part * t).squaredNorm()));
      CHECK(exact.v(part * t).norm() <= orbit.largest_index(v.norm()) * (1 + 1e-12));
      CHECK(orbit.optical_path(part * t, c, s) == doctest::Approx(exact.optical_path(part * t)));
    }
  }
}

TEST_CASE("Luneburg connections in closed form: agree with the general solver") {
  const auto closed = make_ray_field(lens, {&rim, 1});
  const double inside = 1;
  ConnectionStatistics statistics;
  RandomStream random(5, 1, 0);
  for (int i = 0; i < 200; ++i) {
    const double apart = i % 4 == 0 ? 1e-4 : 1;
    const Vec3 from = centre + 0.95 * radius * random_point(random, 1);
    const Vec3 to =
        centre + (1 - apart) * (from - centre) + apart * 0.95 * radius * random_point(random, 1);
    const CurveEndpoints endpoints{from, to, {{&rim, 1}, {&inside, 1}}};
    const ConnectionOptions options{.step = 0.01, .max_length = 10};
    const ConnectionTrial trial(lens, endpoints.region, from, to, options);
    const auto by_steps = trial.along_chord(statistics);
    if (by_steps.outcome != TrialOutcome::converged) continue;
    const auto found = closed->connect(endpoints, options, random, statistics);
    REQUIRE(found.curve);
    CHECK(found.multiplicity == 1);
    CHECK((found.curve->start_direction - by_steps.curve.start_direction).norm() < 1e-7);
    CHECK((found.curve->end_direction - by_steps.curve.end_direction).norm() < 1e-7);
    CHECK(found.curve->sigma == doctest::Approx(by_steps.curve.sigma).epsilon(1e-8));
    CHECK(found.curve->arc_length == doctest::Approx(by_steps.curve.arc_length).epsilon(1e-8));
    CHECK(found.curve->optical_path == doctest::Approx(by_steps.curve.optical_path).epsilon(1e-8));
    CHECK(found.curve->spreading == doctest::Approx(by_steps.curve.spreading).epsilon(1e-6));
    CHECK(found.curve->orientation == by_steps.curve.orientation);
  }
  CHECK(statistics.count(TrialOutcome::converged) > 380);
}

TEST_CASE("Luneburg connections in closed form: coinciding points are degenerate") {
  const auto closed = make_ray_field(lens, {&rim, 1});
  const double inside = 1;
  ConnectionStatistics statistics;
  RandomStream random(6, 1, 0);
  const CurveEndpoints endpoints{centre, centre, {{&rim, 1}, {&inside, 1}}};
  const auto found =
      closed->connect(endpoints, {.step = 0.1, .max_length = 10}, random, statistics);
  CHECK(found.outcome == TrialOutcome::degenerate);
  CHECK(!found.curve);
}

}  // namespace flatspeckle::grin::test_luneburg_orbit
