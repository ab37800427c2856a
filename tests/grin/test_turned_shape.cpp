#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "grin/rays/surfaces/straight_crossing.h"
#include "grin/render/flights/space.h"

namespace flatspeckle::grin::test_turned_shape {

namespace {

/// Rotates a vector by Rodrigues' formula.
Vec3 rotated(const Vec3& x, const Vec3& rotation) {
  const double angle = rotation.norm();
  const Vec3 k = rotation / angle;
  return x * std::cos(angle) + k.cross(x) * std::sin(angle) + k * k.dot(x) * (1 - std::cos(angle));
}

struct Turned {
  const char* name;
  TurnedShape::Shape shape;
  Vec3 middle, rotation;

  Vec3 moved(const Vec3& own) const { return middle + rotated(own - middle, rotation); }
  Surface plain() const {
    return std::visit([](const auto& s) -> Surface { return s; }, shape);
  }
};

const Turned shapes[] = {
    {"box", Box{{-1, -0.5, 0.2}, {0.6, 0.9, 2}}, {-0.2, 0.2, 1.1}, {0.4, -0.7, 0.2}},
    {"lens", *Lens::make({0.3, -0.2, 0.1}, 1, 2, 0, 0.8), {0.3, -0.2, 0.5}, {-1.1, 0.3, 0.6}},
    {"asphere",
     *AsphericLens::make({0, 0, 0}, 0.8, {1 / 2.0, -1, {}}, {0, 0, {}}, 0.6),
     {0, 0, 0.3},
     {0, 2.2, 0.1}}};

}  // namespace

TEST_CASE("turned shapes: lines, distances and normals agree with those of the shape itself") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> even(-1, 1);
  const auto vector = [&] { return Vec3(even(random), even(random), even(random)); };
  for (const Turned& one : shapes) {
    CAPTURE(one.name);
    const TurnedShape turned(one.shape, one.rotation);
    const Surface plain = one.plain();
    const Box box = turned.bounds();
    int met = 0;
    for (int i = 0; i < 200; ++i) {
      const Vec3 own = one.middle + 2 * vector();
      const Vec3 d = (one.middle + 0.5 * vector() - own).normalized();
      const Vec3 x = one.moved(own), along = rotated(d, one.rotation);
      CHECK(std::abs(turned.distance(x) - distance(plain, own)) < 1e-14);
      const bool inside = turned.distance(x) < 0;
      const double length =
          inside ? turned.exit_distance(x, along) : turned.entry_distance(x, along);
      const double wanted = inside ? exit_distance(plain, own, d) : entry_distance(plain, own, d);
      if (wanted == no_crossing) {
        CHECK(length == no_crossing);
        continue;
      }
      ++met;
      CHECK(std::abs(length - wanted) < 1e-12);
      const Vec3 on = x + length * along, on_own = own + wanted * d;
      CHECK((turned.normal(on) - rotated(normal(plain, on_own), one.rotation)).norm() < 1e-11);
      CHECK(box.distance(on) < 1e-12);
      constexpr double h = 1e-5;
      const Vec3 n = turned.normal(on), tangent = n.cross(Vec3(0.3, 0.5, 0.8)).normalized();
      const Vec3 turn = turned.normal(on + h * tangent) - turned.normal(on - h * tangent);
      if (turn.norm() < 0.1)  // not across an edge
        CHECK((turned.curvature(on) * tangent - turn / (2 * h)).norm() < 1e-6);
    }
    CHECK(met > 60);
    CHECK(turned.is_convex() == is_convex(plain));
  }
}

TEST_CASE("cylinders: distances, bounds and volume agree with closed forms") {
  const Vec3 from(1, -2, 0.5), along = Vec3(1, 2, -2) / 3;
  constexpr double length = 4, radius = 0.7;
  const TurnedShape cylinder = TurnedShape::cylinder(from, from + length * along, radius);
  const Vec3 across = along.cross(Vec3::UnitX()).normalized();
  CHECK(cylinder.distance(from + 2 * along) == doctest::Approx(-radius));
  CHECK(cylinder.distance(from + 0.1 * along + 0.2 * across) == doctest::Approx(-0.1));
  CHECK(cylinder.distance(from + 2 * along + 1.5 * across) == doctest::Approx(0.8));
  CHECK(cylinder.volume() == doctest::Approx(std::numbers::pi * radius * radius * length));
  const auto [low, high] = cylinder.bounds();
  for (int a = 0; a < 3; ++a) {
    const double rim = radius * std::sqrt(1 - along[a] * along[a]),
                 end = from[a] + length * along[a];
    CHECK(low[a] == doctest::Approx(std::min(from[a], end) - rim));
    CHECK(high[a] == doctest::Approx(std::max(from[a], end) + rim));
  }
}

TEST_CASE("a turned plate: displaces light by t sin a (1 - cos a / (n cos b))") {
  constexpr double n = 1.5, thickness = 0.8, angle = 0.6;
  Stage stage{Box{{-6, -6, -6}, {6, 6, 6}}};
  stage.bodies.push_back(
      {TurnedShape(Box{{-3, -3, -thickness / 2}, {3, 3, thickness / 2}}, angle * Vec3::UnitY()),
       {},
       n - 1});
  const auto space = make_space(Homogeneous{}, stage);
  const double inner = std::asin(std::sin(angle) / n);
  const double moved = thickness * std::sin(angle) * (1 - std::cos(angle) / (n * std::cos(inner)));
  RandomStream random(1, 0, 0);
  int refracted = 0;
  for (int i = 0; i < 20; ++i) {
    const Flight flight = space->fly({{0.1, 0.2, -5}, around}, Vec3::UnitZ(), random);
    if (flight.crossings.reflected) continue;
    ++refracted;
    CHECK(flight.crossings.count == 2);
    CHECK((flight.direction - Vec3::UnitZ()).norm() < 1e-14);
    CHECK(flight.point.x[0] - 0.1 == doctest::Approx(moved).epsilon(1e-12));
    CHECK(flight.point.x[1] == doctest::Approx(0.2));
  }
  CHECK(refracted > 10);
}

}  // namespace flatspeckle::grin::test_turned_shape
