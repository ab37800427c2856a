#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "bench/scenes/random_fields.h"
#include "grin/surfaces/straight_way.h"
#include "tests/grin/furnace.h"
#include "tests/grin/space_stages.h"

namespace flatspeckle::grin::tests {

namespace {

using std::numbers::pi;

const Surface ball = Sphere{Vec3(0.1, 0, 0), 1};
const Surface block = Box{{-0.9, -0.8, -1}, {0.7, 1, 0.9}};
const Surface bodies[] = {ball, block};
const Box room{Vec3::Constant(-2), Vec3::Constant(2)};

/// Length of the straight way between two points inside of a convex body.
double length_inside(const Surface& body, const Vec3& p, const Vec3& q) {
  const double length = (q - p).norm();
  const Vec3 d = (q - p) / length;
  const double enter = distance(body, p) < 0 ? 0 : std::min(way_in(body, p, d), length);
  if (enter >= length) return 0;
  return std::min(way_out(body, p + (enter + 1e-12) * d, d), length - enter);
}

PathPoint random_point_of(const Surface& body, RandomStream& random) {
  const Vec3 x =
      1.99 * Vec3(2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1);
  return {x, distance(body, x) < 0 ? Part::body : Part::stage};
}

}  // namespace

TEST_CASE("where nothing is refracted, joins go straight through a body's surface") {
  const ScatteringMedium thin{.mu_s = 0.1, .mu_a = 0.1}, thick{.mu_s = 0.7, .mu_a = 0.3};
  for (const Surface& body : bodies) {
    const Stage stage{room, thin, Body{body, thick}, 0.2};
    const StraightSpace<straight_plan> space(stage, 0.2);
    const auto by_legs = make_curved_space(Homogeneous{0.2}, stage, {0.1, 1});
    CHECK(space.joins_all());
    RandomStream random(1, 97, 0);
    ConnectionStatistics statistics;
    int through = 0;
    for (int i = 0; i < 1000; ++i) {
      const PathPoint p = random_point_of(body, random), q = random_point_of(body, random);
      const double length = (q.x - p.x).norm(), inside = length_inside(body, p.x, q.x);
      through += p.part == Part::stage && q.part == Part::stage && inside > 0;
      REQUIRE(space.can_join(p, q));
      for (const auto& join :
           {space.join(p, q, random, statistics), by_legs->join(p, q, random, statistics)}) {
        REQUIRE(join);
        const double depth = 1.0 * inside + 0.2 * (length - inside);
        CHECK(join->optical_depth == doctest::Approx(depth));
        CHECK(join->transmittance == doctest::Approx(std::exp(-depth)));
        CHECK(join->optical_path == doctest::Approx(1.2 * length));
        CHECK(join->spreading == doctest::Approx(length * length));
        CHECK(join->multiplicity == 1);
      }
      CHECK(space.least_depth(p, q) == doctest::Approx(1.0 * inside + 0.2 * (length - inside)));
    }
    CHECK(through > 50);
  }
}

TEST_CASE("a flight through a body where nothing is refracted is what a join finds") {
  const Stage stage{room, {.mu_s = 0.1}, Body{ball, {.mu_s = 0.5}}};
  const StraightSpace<straight_plan> space(stage, 0);
  RandomStream random(2, 97, 0);
  ConnectionStatistics statistics;
  int across = 0;
  for (int i = 0; i < 1000; ++i) {
    const PathPoint p = random_point_of(ball, random);
    const Flight flight = space.fly(p, bench::random_direction(random), random);
    CHECK(flight.is_joinable);
    const auto join = space.join(p, flight.point, random, statistics);
    REQUIRE(join);
    CHECK(join->spreading == doctest::Approx(flight.spreading));
    CHECK(join->optical_depth == doctest::Approx(flight.optical_depth));
    across += flight.crosses_body;
  }
  CHECK(across > 100);
}

namespace {

const Vec3 light_at(0, 0, -1.5), camera_at(1.999, 0, 0);
constexpr double field_of_view = 1.2;

/// L/n^2 that light of power 1 sends to the camera along `d` after one scattering in the body; the
/// rest of the stage is clear. Midpoints.
double along_ray(const Surface& body, const ScatteringMedium& medium, const Vec3& d) {
  const double enter = way_in(body, camera_at, d);
  if (!(enter < 10)) return 0;
  const double length = way_out(body, camera_at + (enter + 1e-12) * d, d);
  constexpr int nodes = 200;
  double sum = 0;
  for (int i = 0; i < nodes; ++i) {
    const double s = (i + 0.5) / nodes * length;
    const Vec3 x = camera_at + (enter + s) * d;
    const double depth = medium.mu_t() * (s + length_inside(body, light_at, x));
    sum += medium.mu_s / (4 * pi) * std::exp(-depth) / (4 * pi * (x - light_at).squaredNorm()) *
           length / nodes;
  }
  return sum;
}

double single_scattering(const Surface& body, const ScatteringMedium& medium) {
  constexpr int nodes = 200;
  const double half = std::tan(field_of_view / 2);
  double sum = 0;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j) {
      const auto at = [&](int k) { return half * ((2 * k + 1.0) / nodes - 1); };
      sum += along_ray(body, medium, Vec3(-1, at(i), at(j)).normalized());
    }
  return sum / (nodes * nodes);
}

RenderScene seen_from_outside(const Surface& body, const ScatteringMedium& medium) {
  return scene_in(Homogeneous{}, {room, {}, Body{body, medium}}, PointLight{light_at},
                  Camera{camera_at, -Vec3::UnitX(), Vec3::UnitY(), field_of_view, {1, 1}});
}

}  // namespace

TEST_CASE("a pinhole, a point light and a body that scatters once: quadrature") {
  const ScatteringMedium medium{.mu_s = 0.5, .mu_a = 0.5};
  for (const Surface& body : {Surface(Sphere{}), block}) {
    const double expected = single_scattering(body, medium);
    for (const RenderMethod method : unbiased_methods) {
      const Rendered result =
          rendered(seen_from_outside(body, medium), {.method = method, .max_scatterings = 1}, 2e5);
      CAPTURE(name(method));
      CHECK(std::abs(result.value() - expected) < 4 * result.error() + 5e-4 * expected);
      CHECK(result.error() < 0.02 * expected);
    }
  }
  CHECK(single_scattering(Sphere{}, medium) == doctest::Approx(2.894e-4).epsilon(0.001));
}

TEST_CASE("a pinhole sees all of a body that scatters light of a point, as a lens does") {
  const ScatteringMedium medium{.mu_s = 0.5, .mu_a = 0.5};
  RenderScene scene = seen_from_outside(Sphere{}, medium);
  const Rendered pinhole = rendered(scene, RenderMethod::bidirectional, 4e5);
  CHECK(pinhole.value() == doctest::Approx(3.74e-4).epsilon(0.03));
  CHECK(pinhole.error() < 0.005 * pinhole.value());
  scene.sensors = {
      Camera{Vec3(2, 0, 0), -Vec3::UnitX(), Vec3::UnitY(), field_of_view, {1, 1}, 0.1, 2}};
  const Rendered lens = rendered(scene, RenderMethod::bidirectional, 4e5);
  CHECK(lens.error() < 0.01 * lens.value());
  CHECK(std::abs(lens.value() - pinhole.value()) <
        4 * std::hypot(lens.error(), pinhole.error()) + 0.002 * pinhole.value());
}

}  // namespace flatspeckle::grin::tests
