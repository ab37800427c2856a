#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "bench/scenes/meshes.h"
#include "core/error.h"
#include "core/numbers/random.h"
#include "grin/rays/marching/ray_jump.h"
#include "grin/rays/marching/trace.h"
#include "grin/rays/surfaces/mesh_distance.h"
#include "grin/rays/surfaces/mesh_surface.h"
#include "grin/rays/surfaces/spline_cell.h"
#include "grin/rays/surfaces/straight_crossing.h"

namespace flatspeckle::grin::tests::test_mesh_surface {

using namespace bench;

namespace {

constexpr double pi = std::numbers::pi;

Vec3 random_point(RandomStream& random, double half) {
  return Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5) * 2 * half;
}
Vec3 any_direction(RandomStream& random) {
  for (;;) {
    const Vec3 x = random_point(random, 1);
    if (x.norm() < 1 && x.norm() > 0.1) return x.normalized();
  }
}

std::vector<Vec3> soup(const TriangleMesh& mesh) {
  std::vector<Vec3> corners;
  for (const auto& triangle : mesh.triangles)
    for (const int corner : triangle) corners.push_back(mesh.corners[corner]);
  return corners;
}

}  // namespace

TEST_CASE("Bernstein polynomials: the first zero agrees with a search by small steps") {
  RandomStream random(1, 1, 9);
  int found = 0, pairs = 0;
  for (int i = 0; i < 2000; ++i) {
    Bernstein<10> p;
    for (double& c : p.c) c = random.uniform() - 0.4;
    p.c[0] = random.uniform();
    const auto at = [&](double t) { return p.split(t).right.c[0]; };
    int first = 0;
    constexpr int samples = 1000;
    while (first < samples && at((first + 1.0) / samples) > 0) ++first;
    const auto zero = p.first_zero(1e-16);
    if (first == samples) {
      // there may be two zeros between samples
      if (zero) CHECK(std::abs(at(*zero)) < 1e-13);
      continue;
    }
    ++found;
    pairs += p.c[9] > 0;
    REQUIRE(zero);
    CHECK(*zero <= (first + 1.0) / samples);
    CHECK(std::abs(at(*zero)) < 1e-14);
    const auto rest = p.without_zero_at_start();
    CHECK(rest.split(0.3).right.c[0] == doctest::Approx((at(0.3) - p.c[0]) / 0.3));
  }
  CHECK(found > 500);
  CHECK(pairs > 100);
}

TEST_CASE(
    "Bernstein polynomials of grazing rays: two close zeros are found, none for a near miss") {
  for (const double gap : {1e-3, 1e-6, -1e-12, -1e-3}) {
    // (t - 0.4)^2 - gap^2, or + gap
    const double constant = 0.16 + (gap > 0 ? -gap * gap : -gap);
    const Bernstein<3> p{{constant, constant - 0.4, constant + 0.2}};
    const auto zero = p.first_zero(1e-16);
    CHECK(zero.has_value() == (gap > 0));
    if (zero) CHECK(*zero == doctest::Approx(0.4 - gap).epsilon(1e-9));
  }
}

TEST_CASE(
    "closed mesh: corners are merged and triangles face outwards, open surfaces are rejected") {
  std::vector<Vec3> corners = soup(cube_mesh(1));
  corners.insert(corners.end(), {Vec3::Zero(), Vec3::Ones(), Vec3::Ones()});  // no area
  const TriangleMesh mesh = closed_mesh(corners);
  CHECK(mesh.corners.size() == 9);
  CHECK(mesh.triangles.size() == 12);
  CHECK(volume(mesh) == doctest::Approx(8));
  CHECK(area(mesh) == doctest::Approx(24));
  std::vector<Vec3> inwards = soup(cube_mesh(1));
  for (std::size_t i = 0; i < inwards.size(); i += 3) std::swap(inwards[i], inwards[i + 1]);
  CHECK(volume(closed_mesh(inwards)) == doctest::Approx(8));
  inwards = soup(cube_mesh(1));
  std::swap(inwards[0], inwards[1]);
  CHECK(closed_mesh(inwards).turned == 1);
  inwards.resize(33);
  CHECK_THROWS_WITH_AS(closed_mesh(inwards), doctest::Contains("not a closed surface"), InputError);
  inwards[0][1] = std::nan("");
  CHECK_THROWS_AS(closed_mesh(inwards), InputError);
  CHECK_THROWS_AS(closed_mesh({}), InputError);
}

TEST_CASE("closed mesh: corners apart by up to 1e-5 of the size are merged") {
  RandomStream random(1, 1, 10);
  const std::vector<Vec3> exact = soup(cube_mesh(1));
  for (const double noise : {1e-16, 1e-12, 1e-9, 1e-7, 1e-6, 1e-4, 1e-2}) {
    CAPTURE(noise);
    std::vector<Vec3> corners = exact;
    for (Vec3& corner : corners) corner += random_point(random, noise);
    if (noise > 1e-5) {
      CHECK_THROWS_WITH_AS(closed_mesh(corners), doctest::Contains("holes: near"), InputError);
      continue;
    }
    const TriangleMesh mesh = closed_mesh(corners);
    CHECK(mesh.corners.size() == 8);
    CHECK(mesh.triangles.size() == 12);
    CHECK(volume(mesh) == doctest::Approx(8).epsilon(20 * noise));
  }
}

TEST_CASE("closed mesh: duplicate bodies and faces back to back are removed") {
  const std::vector<Vec3> cube = soup(cube_mesh(1));
  std::vector<Vec3> twice = cube, beside = cube;
  twice.insert(twice.end(), cube.begin(), cube.end());
  for (const Vec3& corner : cube) beside.push_back(corner + Vec3(2, 0, 0));
  CHECK(volume(closed_mesh(twice)) == doctest::Approx(8));
  CHECK(volume(closed_mesh(beside)) == doctest::Approx(16));
  CHECK(area(closed_mesh(beside)) == doctest::Approx(40));
}

TEST_CASE("closed mesh: no volume and coordinates that are not numbers are rejected by name") {
  std::vector<Vec3> corners = soup(cube_mesh(1));
  for (Vec3& corner : corners) corner[2] = 0;
  CHECK_THROWS_WITH_AS(closed_mesh(corners), doctest::Contains("encloses no volume"), InputError);
  for (int axis = 0; axis < 3; ++axis) {
    corners = soup(cube_mesh(1));
    corners[7][axis] = std::nan("");
    CHECK_THROWS_WITH_AS(closed_mesh(corners), doctest::Contains("corner 2 of triangle 3"),
                         InputError);
  }
}

TEST_CASE("mesh surface: overlapping parts are rejected, cavities are not") {
  const auto with = [](double scale, const Vec3& by, bool turned) {
    std::vector<Vec3> corners = soup(ball_mesh(3)), more = soup(ball_mesh(3));
    for (Vec3& corner : more) corner = scale * corner + by;
    for (std::size_t i = 0; turned && i < more.size(); i += 3) std::swap(more[i], more[i + 1]);
    corners.insert(corners.end(), more.begin(), more.end());
    return mesh_surface(curved_mesh(closed_mesh(corners), 0, 1), "spacing").volume();
  };
  const double ball = volume(ball_mesh(3));
  CHECK(with(0.5, {0.1, 0, 0}, true) == doctest::Approx(ball * 7 / 8).epsilon(0.01));
  CHECK(with(0.5, {2, 0, 0}, false) == doctest::Approx(ball * 9 / 8).epsilon(0.01));
  CHECK_THROWS_AS(with(0.5, {0.1, 0, 0}, false), OverlapError);
  CHECK_THROWS_AS(with(1, {0.7, 0, 0}, false), OverlapError);
  CHECK(with(0.5, {2, 0, 0}, true) == doctest::Approx(ball * 9 / 8).epsilon(0.01));
}

TEST_CASE("mesh distance: distance and winding number of a cube agree with the closed form") {
  const MeshDistance exact(cube_mesh(1)), ball(ball_mesh(3));
  const Box box{Vec3::Constant(-1), Vec3::Constant(1)};
  RandomStream random(1, 1, 0);
  for (int i = 0; i < 500; ++i) {
    const Vec3 x = random_point(random, 3);
    CHECK(exact.unsigned_distance(x, 9) == doctest::Approx(std::abs(box.distance(x))));
    CHECK(exact.unsigned_distance(x, 0.1) ==
          doctest::Approx(std::min(0.1, std::abs(box.distance(x)))));
    const bool inside = box.distance(x) < 0;
    CHECK(std::abs(exact.winding_number(x) - inside) < 0.05);
    if (std::abs(x.norm() - 1) > 0.02)
      CHECK(std::abs(ball.winding_number(x) - (x.norm() < 1)) < 0.05);
  }
}

TEST_CASE("smooth surface of a cube: faces agree with the cube, edges are rounded") {
  const LevelSurface surface = smooth(cube_mesh(1), 0.1);
  const Box box{Vec3::Constant(-1), Vec3::Constant(1)};
  for (const double t : {0.2, 0.5, -0.65}) {
    CHECK(std::abs(surface.distance({t, 0.4, 1})) < 1e-14);
    CHECK(std::abs(surface.distance({-1, t, 0.3})) < 1e-14);
    CHECK((surface.normal({t, 0.4, 1}) - Vec3::UnitZ()).norm() < 1e-13);
    CHECK(surface.curvature({t, 0.4, 1}).norm() < 1e-11);
  }
  CHECK(surface.distance(Vec3(1, 1, 0.3)) > 0);
  CHECK(surface.distance(Vec3(0.97, 0.97, 0.3)) < 0);
  CHECK(std::abs(surface.volume() / 8 - 1) < 0.005);
  CHECK(surface.is_probably_convex());
  RandomStream random(1, 1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = random_point(random, 2);
    const double exact = box.distance(x), d = surface.distance(x);
    CHECK(std::abs(d) <= std::abs(exact) + 0.05);
    if (std::abs(exact) > 0.05) CHECK((d < 0) == (exact < 0));
  }
}

TEST_CASE("smooth surface of a ball: the error is of fourth order in the spacing") {
  const TriangleMesh mesh = ball_mesh(6);
  const double radius = std::cbrt(volume(mesh) * 3 / (4 * pi));
  RandomStream random(1, 1, 2);
  for (const double spacing : {0.25, 0.125}) {
    const LevelSurface surface = smooth(mesh, spacing);
    const double allowed = spacing > 0.2 ? 1e-3 : 1.5e-4;
    CHECK(std::abs(surface.volume() / volume(mesh) - 1) < 3 * allowed);
    CHECK(surface.is_probably_convex());
    for (int i = 0; i < 300; ++i) {
      const Vec3 from = any_direction(random) * 4;
      const Vec3 d = (random_point(random, 0.4) - from).normalized();
      const double ray_length = surface.crossing_distance(from, d, 1);
      REQUIRE(ray_length < 10);
      CHECK(ray_length >= surface.distance(from) - 1e-12);
      const Vec3 x = from + ray_length * d, n = x.normalized();
      CHECK(std::abs(x.norm() - radius) < 2 * allowed);
      CHECK((surface.normal(x) - n).norm() < 0.02);
      const Mat3 turn = surface.curvature(x) - (Mat3::Identity() - n * n.transpose()) / radius;
      CHECK((turn * (Mat3::Identity() - n * n.transpose())).norm() < 0.15);
      // the curvature agrees with differences of the normal
      const Vec3 aside = 1e-5 * n.cross(any_direction(random));
      const Vec3 change = surface.normal(x + aside) - surface.normal(x - aside);
      CHECK((change - 2 * surface.curvature(x) * aside).norm() < 1e-3 * aside.norm());
    }
  }
}

TEST_CASE("lines through a torus: crossings agree with the changes of sign") {
  const LevelSurface surface = smooth(torus_mesh(), 0.06);
  CHECK(!surface.is_probably_convex());
  RandomStream random(1, 1, 3);
  int crossings[6] = {};
  for (int i = 0; i < 1500; ++i) {
    const Vec3 from = any_direction(random) * 2;
    const Vec3 d = (random_point(random, 0.6) - from).normalized();
    std::vector<double> distances{0};
    for (double side = 1;; side = -side) {
      const double ray_length = surface.crossing_distance(from + distances.back() * d, d, side);
      if (ray_length == no_crossing) break;
      distances.push_back(distances.back() + ray_length);
      REQUIRE(distances.size() < 7);
      CHECK(std::abs(surface.distance(from + distances.back() * d)) < 1e-15);
    }
    REQUIRE(distances.size() % 2 == 1);
    ++crossings[(distances.size() - 1)];
    for (double s = 0; s < 4; s += 0.01) {
      std::size_t passed = 0;
      while (passed + 1 < distances.size() && distances[passed + 1] < s) ++passed;
      CHECK((surface.distance(from + s * d) < 0) == (passed % 2 == 1));
    }
  }
  for (const int count : {0, 2, 4}) CHECK(crossings[count] > 50);
}

TEST_CASE("points on a smooth surface: crossings agree with the given side") {
  const LevelSurface ball = smooth(ball_mesh(5), 0.15), cube = smooth(cube_mesh(1), 0.25);
  RandomStream random(1, 1, 4);
  for (const LevelSurface& surface : {ball, cube}) {
    for (int i = 0; i < 3000; ++i) {
      const Vec3 from = any_direction(random) * 3;
      const Vec3 d = (random_point(random, 0.5) - from).normalized();
      Vec3 x = from + surface.crossing_distance(from, d, 1) * d;
      x += (random.uniform() - 0.5) * 2e-14 * d;  // within rounding
      const Vec3 n = surface.normal(x);
      const double steep = std::pow(10, -6 * random.uniform());  // down to a grazing 1e-6
      const Vec3 along = n.cross(any_direction(random)).normalized();
      const Vec3 out = (along + steep * n).normalized(), in = (along - steep * n).normalized();
      CHECK(surface.crossing_distance(x, out, 1) > 1e-9);
      CHECK(surface.crossing_distance(x, in, -1) > 1e-9);
      CHECK(surface.crossing_distance(x, in, -1) < 4);
      CHECK(surface.crossing_distance(x, in, 1) < 1e-7);
      CHECK(surface.crossing_distance(x, out, -1) < 1e-7);
    }
  }
}

TEST_CASE("smooth surface: rays by steps end at the entry distance of straight lines") {
  const std::vector<Surface> surfaces{smooth(torus_mesh(), 0.06)};
  RandomStream random(1, 1, 5);
  for (int i = 0; i < 200; ++i) {
    const Vec3 from = any_direction(random) * 2;
    const Vec3 d = (random_point(random, 0.5) - from).normalized();
    const double ray_length = entry_distance(surfaces[0], from, d);
    FixedSteps<Leapfrog> none{1};
    RayState ray = start_ray(Homogeneous{}, from, d);
    const TraceEnd end = trace(Homogeneous{}, surfaces, {10, 1e-9}, none, ray);
    CHECK((end.stop == Stop::surface) == (ray_length < 10));
    if (ray_length < 10) CHECK(ray.arc_length == doctest::Approx(ray_length).epsilon(1e-6));
  }
}

TEST_CASE("default spacing: finer for thin meshes") {
  const auto bar = [](double y, double z) {
    TriangleMesh mesh = cube_mesh(1);
    for (Vec3& corner : mesh.corners) corner = corner.cwiseProduct(Vec3(1, y, z));
    return curved_mesh(mesh, 0, 1);
  };
  CHECK(mesh_surface(bar(0.3, 0.3), "spacing").spacing() == 2.0 / 64);
  CHECK(mesh_surface(bar(0.3, 0.05), "spacing").spacing() == 2.0 / 128);
  CHECK(mesh_surface(bar(0.02, 0.02), "spacing").spacing() == 2.0 / 256);
  CHECK_THROWS_WITH_AS(mesh_surface(bar(1e-3, 1e-3), "spacing"), doctest::Contains("too coarse"),
                       InputError);
}

TEST_CASE("spacing: too coarse and too fine values are rejected") {
  const TriangleMesh mesh = torus_mesh();
  CHECK_THROWS_WITH_AS(smooth(mesh, 0.4), doctest::Contains("too coarse"), InputError);
  CHECK_THROWS_WITH_AS(smooth(mesh, 5), doctest::Contains("too coarse"), InputError);
  CHECK_THROWS_WITH_AS(smooth(mesh, 1e-3), doctest::Contains("too fine"), InputError);
  TriangleMesh far = mesh;
  for (Vec3& corner : far.corners) corner[0] += 1e9;
  CHECK_THROWS_WITH_AS(smooth(far, 0.1), doctest::Contains("too fine"), InputError);
}

}  // namespace flatspeckle::grin::tests::test_mesh_surface
