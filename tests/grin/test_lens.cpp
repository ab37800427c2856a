#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "grin/rays/surfaces/lens.h"
#include "grin/rays/surfaces/straight_crossing.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_lens {

using flatspeckle::tests::is_night;

namespace {

struct Shape {
  const char* name;
  double front, back;
};
constexpr Shape shapes[] = {{"biconvex", 2, -3},        {"biconcave", -2, 3},
                            {"meniscus", 2, 2.5},       {"plano-convex", 0, -1.5},
                            {"plano-concave", -1.2, 0}, {"rod", 0, 0}};

Lens lens_of(const Shape& shape) {
  return *Lens::make({0.3, -0.2, 0.1}, 1, shape.front, shape.back, 0.8);
}
Vec3 random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> even(-size, size);
  return {even(random), even(random), even(random)};
}
Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3{normal(random), normal(random), normal(random)}.normalized();
}
/// Returns the distance to a change of side, by small steps; no_crossing beyond 12.
double marched(const Lens& lens, const Vec3& x, const Vec3& d) {
  const bool inside = lens.distance(x) < 0;
  for (double ray_length = 0; ray_length < 12; ray_length += 1e-3)
    if ((lens.distance(x + ray_length * d) < 0) != inside) return ray_length;
  return no_crossing;
}

}  // namespace

TEST_CASE("lens: the signed distance changes by at most the distance between points") {
  std::mt19937 random(1);
  for (const Shape& shape : shapes) {
    CAPTURE(shape.name);
    const Lens lens = lens_of(shape);
    for (int i = 0; i < 300; ++i) {
      const Vec3 x = random_point(random, 2), y = random_point(random, 2);
      CHECK(std::abs(lens.distance(x) - lens.distance(y)) <= (x - y).norm() * (1 + 1e-12));
    }
  }
}

TEST_CASE("lens: entry and exit distances agree with small steps and end on the surface") {
  std::mt19937 random(2);
  for (const Shape& shape : shapes) {
    CAPTURE(shape.name);
    const Lens lens = lens_of(shape);
    int met = 0;
    for (int i = 0; i < (is_night ? 800 : 300); ++i) {
      const Vec3 x = random_point(random, 1.8), d = random_direction(random);
      const bool inside = lens.distance(x) < 0;
      const double ray_length = inside ? exit_distance(lens, x, d) : entry_distance(lens, x, d);
      const double seen = marched(lens, x, d);
      CAPTURE(i);
      if (ray_length == no_crossing) {
        CHECK(seen == no_crossing);
        continue;
      }
      ++met;
      CHECK(std::abs(lens.distance(x + ray_length * d)) < 1e-13);
      if (seen != no_crossing)
        CHECK(std::abs(ray_length - seen) < 1.1e-3);  // steps may miss an edge
    }
    CHECK(met > (is_night ? 60 : 20));
  }
}

TEST_CASE("lens: a ray that leaves a concave face meets its far side") {
  const Lens lens = *Lens::make({0, 0, 0}, 1, -1.2, 0, 0.2);
  const Vec3 x(-0.9, 0, -1.2 + std::sqrt(1.44 - 0.81));
  CHECK(std::abs(lens.distance(x)) < 1e-14);
  CHECK(entry_distance(lens, x, Vec3::UnitX()) == doctest::Approx(1.8));
}

TEST_CASE("lens: a ray that leaves within a tolerance of the surface does not meet it again") {
  const Lens rod = *Lens::make({0, 0, 0}, 0.9, 0, 0, 3), ball = *Lens::make({0, 0, 0}, 1, 1, -1, 2);
  for (const double before : {0.0, 1e-15, 1e-10}) {
    CAPTURE(before);
    CHECK(entry_distance(rod, {0, 0, 3 - before}, Vec3::UnitZ()) == no_crossing);
    CHECK(entry_distance(rod, {0.9 - before, 0, 1}, Vec3::UnitX()) == no_crossing);
    CHECK(entry_distance(ball, {0, 0, before}, -Vec3::UnitZ()) == no_crossing);
  }
}

TEST_CASE("lens: differences of the normal agree with the curvature") {
  constexpr double h = 1e-5;
  for (const Shape& shape : shapes) {
    CAPTURE(shape.name);
    const Lens lens = lens_of(shape);
    for (const Vec3& from : {Vec3(0.4, 0.1, -3), Vec3(0.4, 0.1, 3), Vec3(4, 0.3, 0.5)}) {
      const Vec3 towards = (Vec3(0.4, 0, 0.5) - from).normalized();
      const Vec3 x = from + entry_distance(lens, from, towards) * towards;
      const Vec3 n = lens.normal(x);
      const Vec3 along = n.cross(Vec3(0.3, 0.5, 0.8)).normalized();
      const Vec3 turn = (lens.normal(x + h * along) - lens.normal(x - h * along)) / (2 * h);
      CHECK((lens.curvature(x) * along - turn).norm() < 1e-8);
      CHECK(n.dot(towards) < 0);
    }
  }
}

TEST_CASE("lens: impossible shapes are rejected") {
  CHECK_FALSE(Lens::make({0, 0, 0}, 1, 0.9, 0, 1));
  CHECK_FALSE(Lens::make({0, 0, 0}, 1, 1, -1, 1.9));  // faces meet within the radius
  CHECK(Lens::make({0, 0, 0}, 1, 1, -1, 2));          // a ball
  CHECK_FALSE(Lens::make({0, 0, 0}, 1, -1, 1, 0));
}

}  // namespace flatspeckle::grin::test_lens
