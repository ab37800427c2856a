#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "bench/scenes/random_fields.h"
#include "grin/rays/connections/connection_solver.h"
#include "grin/render/curved/parabolic_rays.h"

namespace flatspeckle::grin::test_parabolic_curves {

using bench::random_direction;
using bench::random_point;

namespace {

constexpr double n0 = 1.6, alpha = 0.5, longest = 120;
const Vec3 centre(0.2, -0.1, 3);
const ParabolicGuide guide({n0 - 1, alpha}, centre);
const Surface sides = Box{Vec3(-1.9, -1.9, 0), Vec3(1.9, 1.9, 42)};
const double inside = 1;
const Sides domain{{&sides, 1}, {&inside, 1}, 1e-7};

Vec3 near_axis(double z, RandomStream& random) {
  return centre + Vec3(1.6 * random.uniform() - 0.8, 1.6 * random.uniform() - 0.8, z);
}

void check_same(const Connection& found, const Connection& curve) {
  CHECK((found.end_direction - curve.end_direction).norm() < 1e-4);
  CHECK(found.arc_length == doctest::Approx(curve.arc_length).epsilon(1e-5));
  CHECK(found.optical_path == doctest::Approx(curve.optical_path).epsilon(1e-5));
  CHECK(found.spreading == doctest::Approx(curve.spreading).epsilon(1e-3));
  CHECK(found.orientation == curve.orientation);
}

void check_stays(const CurveEndpoints& endpoints, const Connection& curve) {
  constexpr int steps = 600;
  RayState ray = start_ray(guide, endpoints.from, curve.start_direction);
  bool stays = true;
  for (int i = 0; i < steps; ++i) {
    stays = stays && domain(ray.x);
    Sharma::step(guide, ray, curve.sigma / steps);
  }
  CHECK(stays);
  CHECK((ray.x - endpoints.to).norm() < 1e-5);
}

}  // namespace

TEST_CASE("parabolic rays in closed form: rays and tangents agree with small steps") {
  RandomStream random(3, 1, 0);
  for (int i = 0; i < 30; ++i) {
    const Vec3 x = random_point(random, 1);
    RayState ray = start_ray(guide, centre + x, random_direction(random));
    RayTangent tangent;
    const double t = 12 * random.uniform(), sigma = t / alpha;
    const ParabolicOrbit orbit(n0, alpha, x, ray.v);
    constexpr int steps = 4000;
    for (int j = 0; j < steps; ++j) Sharma::step(guide, ray, tangent, sigma / steps);
    const RayState found = orbit.at(t);
    CHECK((found.x + centre - ray.x).norm() < 1e-9);
    CHECK((found.v - ray.v).norm() < 1e-9);
    CHECK(found.arc_length == doctest::Approx(ray.arc_length).epsilon(1e-8));
    CHECK(found.optical_path == doctest::Approx(ray.optical_path).epsilon(1e-9));
    CHECK((orbit.tangent_at(t).dx - tangent.dx).norm() < 1e-8);
    CHECK((orbit.tangent_at(t).dv - tangent.dv).norm() < 1e-9);
  }
}

TEST_CASE("parabolic connections in closed form: each curve is a ray and found once") {
  RandomStream random(4, 1, 0);
  int curves = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 x0 = random_point(random, 1);
    const double t = 20 * random.uniform();
    const Vec3 v = index(guide, centre + x0) * random_direction(random);
    const Vec3 x1 = ParabolicOrbit(n0, alpha, x0, v).at(t).x;
    int same = 0;
    double before = 0;
    ParabolicCurves(n0, alpha, x0, x1).each(25, [&](double found, const Vec3& start) {
      ++curves;
      CHECK(found > before);
      before = found;
      const RayState end = ParabolicOrbit(n0, alpha, x0, start).at(found);
      CHECK((end.x - x1).norm() < 1e-7);
      CHECK(end.v.norm() == doctest::Approx(index(guide, centre + x1)).epsilon(1e-8));
      same += std::abs(found - t) < 1e-6 && (start - v).norm() < 1e-5;
    });
    CHECK(same == 1);
  }
  CHECK(curves > 1000);
}

TEST_CASE(
    "parabolic connections in closed form: drawn evenly from all curves of the general solver") {
  const ParabolicRays closed(guide, sides);
  const RayFieldOf stepped(guide);
  RandomStream random(5, 1, 0);
  ConnectionStatistics statistics;
  const ConnectionOptions options{.step = 0.1, .max_length = longest};
  int twice = 0;
  for (int i = 0; i < 12; ++i) {
    const CurveEndpoints endpoints{near_axis(-2.5, random), near_axis(37, random), domain};
    const auto all = stepped.connections(endpoints, options, 300, random, statistics);
    std::vector<int> drawn(all.size());
    constexpr int draws = 100;
    double number = 0;
    for (int j = 0; j < draws; ++j) {
      const auto found = closed.connect(endpoints, options, random, statistics);
      if (!found.curve) continue;
      number = found.multiplicity;
      check_stays(endpoints, *found.curve);
      for (std::size_t k = 0; k < all.size(); ++k) {
        const Connection& curve = all[k].curve;
        if ((found.curve->start_direction - curve.start_direction).norm() > 1e-4) continue;
        ++drawn[k];
        check_same(*found.curve, curve);
      }
    }
    CHECK(number >= all.size());  // the solver finds some once in a thousand trials
    twice += all.size() > 1;
    const double share = draws / std::max(1.0, number);
    for (const int count : drawn) CHECK(std::abs(count - share) <= 4.5 * std::sqrt(share));
  }
  CHECK(twice > 2);
}

}  // namespace flatspeckle::grin::test_parabolic_curves
