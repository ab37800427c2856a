#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "bench/scenes/meshes.h"
#include "bench/scenes/random_fields.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/rays/surfaces/straight_crossing.h"
#include "grin/render/endpoints/path_end.h"
#include "tests/grin/furnace.h"
#include "tests/grin/space_stages.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::tests::test_connections_through_body {

namespace {

using std::numbers::pi;

const Surface ball = Sphere{Vec3(0.1, 0, 0), 1};
const Surface block = Box{{-0.9, -0.8, -1}, {0.7, 1, 0.9}};
const Surface bodies[] = {ball, block};
const Box stage_box{Vec3::Constant(-2), Vec3::Constant(2)};
constexpr double reach = 1.99, near_bodies = 1;  // half sides of the cubes of random points
const double part_by_day = is_night ? 1 : 0.5;   // fraction of the samples of renders

/// Returns the length inside a convex body of the segment between two points.
double length_inside(const Surface& body, const Vec3& p, const Vec3& q) {
  const double length = (q - p).norm();
  const Vec3 d = (q - p) / length;
  const double enter = distance(body, p) < 0 ? 0 : std::min(entry_distance(body, p, d), length);
  if (enter >= length) return 0;
  return std::min(exit_distance(body, p + (enter + 1e-12) * d, d), length - enter);
}

PathPoint random_point_of(const Stage& stage, RandomStream& random, double size = reach) {
  const Vec3 x =
      size * Vec3{2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
  return {x, Regions(stage).at(x)};
}

}  // namespace

TEST_CASE("connections through a body without refraction: straight lines, closed form") {
  const ScatteringMedium thin{.mu_s = 0.1, .mu_a = 0.1}, thick{.mu_s = 0.7, .mu_a = 0.3};
  for (const Surface& body : bodies) {
    const Stage stage{stage_box, thin, {Body{body, thick}}, 0.2};
    const Space space(Homogeneous{0.2}, stage);
    const auto by_segments = make_space(Homogeneous{0.2}, stage, {0.1, 1});
    CHECK(!space.connects_through());
    RandomStream random(1, 97, 0);
    ConnectionStatistics statistics;
    int through = 0;
    for (int i = 0; i < 500; ++i) {
      const PathPoint p = random_point_of(stage, random), q = random_point_of(stage, random);
      const double length = (q.x - p.x).norm(), inside = length_inside(body, p.x, q.x);
      through += p.part == around && q.part == around && inside > 0;
      REQUIRE(space.can_connect(p, q));
      for (const auto& connection : {space.connect(p, q, random, statistics),
                                     by_segments->connect(p, q, random, statistics)}) {
        REQUIRE(connection);
        const double depth = 1.0 * inside + 0.2 * (length - inside);
        CHECK(connection->optical_depth == doctest::Approx(depth));
        CHECK(connection->transmittance == doctest::Approx(std::exp(-depth)));
        CHECK(connection->optical_path == doctest::Approx(1.2 * length));
        CHECK(connection->spreading == doctest::Approx(length * length));
        CHECK(connection->multiplicity == 1);
      }
      CHECK(space.least_depth(p, q) == doctest::Approx(1.0 * inside + 0.2 * (length - inside)));
    }
    CHECK(through > 50);
  }
}

TEST_CASE("flights through a body without refraction: spreading and depth agree with connections") {
  const Stage stage{stage_box, {.mu_s = 0.1}, {Body{ball, {.mu_s = 0.5}}}};
  const Space space(Homogeneous{0}, stage);
  RandomStream random(2, 97, 0);
  ConnectionStatistics statistics;
  int across = 0;
  for (int i = 0; i < 1000; ++i) {
    const PathPoint p = random_point_of(stage, random);
    const Flight flight = space.fly(p, bench::random_direction(random), random);
    CHECK(flight.is_connectable);
    const auto connection = space.connect(p, flight.point, random, statistics);
    REQUIRE(connection);
    CHECK(connection->spreading == doctest::Approx(flight.spreading));
    CHECK(connection->optical_depth == doctest::Approx(flight.optical_depth));
    across += flight.crosses_body;
  }
  CHECK(across > 100);
}

namespace {

const Vec3 light_at(0, 0, -1.5), camera_at(1.999, 0, 0);
constexpr double field_of_view = 1.2;

/// Returns the L/n^2 that a light of power 1 sends to the camera along `d` after one scattering in
/// the body, by the midpoint rule; the rest of the stage is clear.
double along_ray(const Surface& body, const ScatteringMedium& medium, const Vec3& d) {
  const double enter = entry_distance(body, camera_at, d);
  if (!(enter < 10)) return 0;
  const double length = exit_distance(body, camera_at + (enter + 1e-12) * d, d);
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

double single_scattering(const Surface& body, const ScatteringMedium& medium, int nodes = 200) {
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
  return scene_in(Homogeneous{}, {stage_box, {}, {Body{body, medium}}}, PointLight{light_at},
                  Camera{camera_at, -Vec3::UnitX(), Vec3::UnitY(), field_of_view, {1, 1}});
}

}  // namespace

TEST_CASE("single scattering in a body: pinhole pictures agree with quadrature") {
  const ScatteringMedium medium{.mu_s = 0.5, .mu_a = 0.5};
  for (const Surface& body : {Surface(Sphere{}), block}) {
    const double expected = single_scattering(body, medium);
    constexpr double accuracy = 5e-4;  // relative error of the quadrature
    CHECK(std::abs(single_scattering(body, medium, 141) - expected) < accuracy * expected);
    for (const RenderMethod method : unbiased_methods) {
      const Rendered result = rendered(seen_from_outside(body, medium),
                                       {.method = method, .max_scatterings = 1}, part_by_day * 2e5);
      CAPTURE(name(method));
      CHECK(std::abs(result.value() - expected) < 4 * result.error() + accuracy * expected);
      CHECK(result.error() < 0.02 * expected);
    }
  }
}

TEST_CASE("scattering body under a point light: a pinhole agrees with a small lens") {
  const ScatteringMedium medium{.mu_s = 0.5, .mu_a = 0.5};
  RenderScene scene = seen_from_outside(Sphere{}, medium);
  const Rendered pinhole = rendered(scene, RenderMethod::bidirectional, part_by_day * 4e5);
  CHECK(pinhole.error() < 0.005 * pinhole.value());
  scene.sensors = {
      Camera{Vec3(2, 0, 0), -Vec3::UnitX(), Vec3::UnitY(), field_of_view, {1, 1}, 0.1, 2}};
  const Rendered lens = rendered(scene, RenderMethod::bidirectional, part_by_day * 4e5);
  CHECK(lens.error() < 0.01 * lens.value());
  CHECK(std::abs(lens.value() - pinhole.value()) <
        4 * std::hypot(lens.error(), pinhole.error()) + 0.002 * pinhole.value());
}

TEST_CASE("body of the same medium as the one around it: connections and pictures are unchanged") {
  const ScatteringMedium medium{.mu_s = 0.5, .mu_a = 0.5};
  Stage whole{stage_box, {.mu_s = 0.2}, {Body{ball, medium, 0.4}}}, divided = whole;
  divided.bodies.push_back({Sphere{Vec3(0.3, 0.2, -0.1), 0.6}, medium, 0.4});
  const Space one(Homogeneous{0}, whole), two(Homogeneous{0}, divided);
  RandomStream random(7, 97, 0);
  ConnectionStatistics statistics;
  int connected = 0;
  for (int i = 0; i < 20000; ++i) {
    const PathPoint p = random_point_of(divided, random), q = random_point_of(divided, random);
    const auto in = [&](const PathPoint& at) { return PathPoint{at.x, std::min(at.part, 1)}; };
    const auto connection = two.connect(p, q, random, statistics);
    const auto same = one.connect(in(p), in(q), random, statistics);
    REQUIRE(connection.has_value() == same.has_value());
    if (!connection) continue;
    connected += p.part != q.part;
    CHECK(connection->spreading == doctest::Approx(same->spreading));
    CHECK(connection->optical_depth == doctest::Approx(same->optical_depth));
    CHECK(connection->transmittance == doctest::Approx(same->transmittance));
  }
  CHECK(connected > 10);
  RenderScene scene = seen_from_outside(ball, medium);
  const auto value = [&](const Stage& stage) {
    scene.stage = stage;
    return rendered(scene, {.method = RenderMethod::bidirectional}, part_by_day * 2e5);
  };
  const Rendered before = value(whole), after = value(divided);
  CHECK(before.error() < 0.03 * before.value());
  CHECK(after.error() < 0.03 * after.value());
  CHECK(std::abs(before.value() - after.value()) < 4 * std::hypot(before.error(), after.error()));
}

namespace {

struct NamedSpace {
  std::string name;
  Stage stage;
  AnyIndexField field;
};

/// Returns refracting bodies: denser and rarer, with flat and curved surfaces, with straight and
/// curved rays inside, nested and side by side.
std::vector<NamedSpace> refracting() {
  const ScatteringMedium thin{.mu_s = 0.2}, thick{.mu_s = 0.7, .mu_a = 0.3}, dense{.mu_s = 2};
  const Surface middle = Sphere{Vec3(0.3, 0.2, -0.1), 0.6};
  const Body core{middle, dense, 0.2}, alike{middle, dense, 0.5}, bubble{middle, dense, 0.1},
      beside{Box{{1.2, -1, -1}, {1.8, 1, 1}}, thick, 0.3}, shell{ball, thick, 0.3},
      filled{middle, thick};
  const auto with_more = [](Stage stage, const std::vector<const Body*>& more) {
    for (const Body* body : more) stage.bodies.push_back(*body);
    return stage;
  };
  const auto with = [&](const Surface& body) {
    return Stage{stage_box, thin, {Body{body, thick}}, 0.1};
  };
  return {{"glass ball", with(ball), Homogeneous{0.5}},
          {"bubble", with(ball), Homogeneous{-0.2}},
          {"glass block", with(block), Homogeneous{0.5}},
          {"ball of triangles", with(bench::smooth(bench::ball_mesh(5), 0.2)), Homogeneous{0.5}},
          {"Luneburg ball", Stage{stage_box, thin, {Body{Sphere{}, thick}}}, Luneburg({})},
          {"fisheye ball", with(ball), Fisheye({.centre_excess = 0.6, .radius = 2})},
          {"fisheye block", with(block), Fisheye({.centre_excess = 0.6, .radius = 2})},
          {"ball in a ball", with_more(with(ball), {&core}), Homogeneous{0.5}},
          {"same index in a ball", with_more(with(ball), {&alike}), Homogeneous{0.5}},
          {"bubble in a ball, block beside", with_more(with(ball), {&bubble, &beside}),
           Homogeneous{0.5}},
          {"ball in a fisheye ball", with_more(with(ball), {&core}),
           Fisheye({.centre_excess = 0.6, .radius = 2})},
          {"fisheye ball in a ball", with_more(Stage{stage_box, thin}, {&shell, &filled}),
           Fisheye({.centre_excess = 0.6, .radius = 2})}};
}

template <class Use>
void with_space(const NamedSpace& named, const Use& use) {
  if (const auto* homogeneous = std::get_if<Homogeneous>(&named.field))
    use(Space(Homogeneous{homogeneous->n_excess}, named.stage));
  use(*make_space(named.field, named.stage, {0.05, 40}));
}

/// Whether a connection follows the path of another connection or a flight.
template <class SpecularPath>
bool alike(const TestConnection& connection, const SpecularPath& path) {
  return (connection.start_direction - path.start_direction).norm() < 1e-4 &&
         std::abs(connection.optical_path - path.optical_path) < 1e-4;
}

/// Returns the connection from p to q along this path, if one of the trials finds it.
template <class SpecularPath>
std::optional<TestConnection> same_path(const Space& space, const PathPoint& p, const PathPoint& q,
                                        const SpecularPath& path, int trials,
                                        RandomStream& random) {
  ConnectionStatistics statistics;
  for (int i = 0; i < trials; ++i) {
    const auto connection = space.connect_through(p, q, random, statistics);
    if (connection && alike(*connection, path)) return connection;
  }
  return std::nullopt;
}

}  // namespace

TEST_CASE("refracted flights: agree with the connection of their endpoints") {
  for (const NamedSpace& named : refracting())
    with_space(named, [&](const auto& space) {
      CAPTURE(named.name);
      RandomStream random(3, 97, 0);
      constexpr int trials = 100000;  // some paths are found by one trial in thousands
      int flights = 0, missed = 0;
      for (int i = 0; i < (is_night ? 1000 : 120); ++i) {
        const PathPoint p = random_point_of(named.stage, random);
        const Flight flight = space.fly(p, bench::random_direction(random), random);
        if (flight.crossings.count == 0 || flight.crossings.count > 3 ||
            flight.end == Flight::End::lost)
          continue;
        ++flights;
        const auto connection = same_path(space, p, flight.point, flight, trials, random);
        missed += !connection;
        if (!connection) continue;
        CHECK((connection->end_direction - flight.direction).norm() < 1e-4);
        CHECK(connection->spreading == doctest::Approx(flight.spreading).epsilon(1e-4));
        CHECK(connection->optical_depth == doctest::Approx(flight.optical_depth).epsilon(1e-4));
        CHECK(connection->fresnel == doctest::Approx(flight.fresnel).epsilon(1e-4));
        CHECK(connection->concave_crossings == flight.concave_crossings);
        Flight there;
        there.start_direction = -flight.direction;
        there.optical_path = flight.optical_path;
        const auto back = same_path(space, flight.point, p, there, trials, random);
        if (!back) continue;
        const double n_p = space.index(p), n_q = space.index(flight.point);
        CHECK(connection->fresnel == doctest::Approx(back->fresnel).epsilon(1e-4));
        CHECK(connection->concave_crossings == back->concave_crossings);
        CHECK(n_q * n_q * connection->spreading ==
              doctest::Approx(n_p * n_p * back->spreading).epsilon(1e-4));
      }
      CHECK(flights > (is_night ? 25 : 3));
      CHECK(missed == 0);
    });
}

TEST_CASE("refracted flights: |J| agrees with differences of neighbouring flights") {
  for (const NamedSpace& named : refracting())
    with_space(named, [&](const auto& space) {
      CAPTURE(named.name);
      RandomStream random(4, 97, 0);
      int compared = 0;
      for (int i = 0; i < 2000; ++i) {
        const PathPoint p = random_point_of(named.stage, random);
        const Vec3 d = bench::random_direction(random);
        const Frame across = frame_across(d);
        constexpr double turn = 1e-5;
        const auto fly = [&](const Vec3& direction) {  // to the boundary, with the same reflections
          RandomStream same(5, 97, i);
          return space.fly(p, direction.normalized(), same);
        };
        const Flight middle = fly(d);
        if (middle.crossings.count == 0 || middle.end != Flight::End::boundary) continue;
        Eigen::Matrix<double, 3, 2> moved;
        bool same = true;
        for (int k = 0; k < 2; ++k) {
          const Flight one = fly(d + turn * across.col(k)), two = fly(d - turn * across.col(k));
          same &= one.end == Flight::End::boundary && two.end == Flight::End::boundary &&
                  one.crossings == middle.crossings && two.crossings == middle.crossings;
          // the endpoints also differ along the ray, which the frame across it removes
          moved.col(k) = (one.point.x - two.point.x) / (2 * turn);
        }
        if (!same) continue;
        const double expected =
            std::abs((frame_across(middle.direction).transpose() * moved).determinant());
        if (expected > 1e3 || expected < 0.1) continue;  // near grazing incidence or a caustic
        ++compared;
        CHECK(middle.spreading == doctest::Approx(expected).epsilon(2e-3));
      }
      CHECK(compared > 20);
    });
}

namespace {

struct Mean {
  double sum = 0, squares = 0;
  long count = 0;

  void add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double mean() const { return sum / static_cast<double>(count); }
  double error() const {
    const double n = static_cast<double>(count);
    return std::sqrt(std::max(0.0, squares / n - mean() * mean()) / (n - 1));
  }
};

/// Returns the fraction of a path that both sides count, a function of the path alone: sums over
/// focusing paths have unbounded variance, and paths that graze a surface or are reflected often
/// are rarely found.
template <class SpecularPath>
double share(const Space& space, const PathPoint& q, const SpecularPath& path) {
  if (path.crossings.count > 2) return 0;
  return path.fresnel *
         std::min(1.0, path.spreading * std::pow(space.index(q) / path.optical_path, 2));
}

/// Returns the density of the random points, of which every other one is near the bodies.
double density_of_points(const Vec3& x) {
  const auto in_cube = [&](double size) {
    return x.cwiseAbs().maxCoeff() < size ? std::pow(2 * size, -3) : 0;
  };
  return (in_cube(reach) + in_cube(near_bodies)) / 2;
}

}  // namespace

TEST_CASE(
    "collisions in and around a refracting body: densities of flights and connections agree") {
  int number = 0;
  for (const NamedSpace& named : refracting())
    for (const Vec3& at : {Vec3(0.3, -0.4, -1.7), Vec3(0.2, 0.3, -0.4)}) {
      if (!is_night && ++number % 5 != 0) continue;  // by day every fifth, at either place
      const PathPoint p{at, Regions(named.stage).at(at)};
      CAPTURE(named.name);
      CAPTURE(at);
      const auto space = make_space(named.field, named.stage, {0.05, 40});
      RandomStream random(6, 97, 0);
      ConnectionStatistics statistics;
      std::vector<Mean> flown(named.stage.parts()), connected(flown);  // from refracted light only
      const flatspeckle::tests::Effort effort = flatspeckle::tests::effort();
      for (int i = 0; i < 100000 * effort.samples; ++i) {
        const Flight flight = space->fly(p, bench::random_direction(random), random);
        const bool counts = flight.end == Flight::End::collision && flight.is_connectable &&
                            flight.crossings.count > 0 &&
                            flight.point.x.cwiseAbs().maxCoeff() < reach;
        const double seen = counts ? share(*space, flight.point, flight) : 0;
        for (Part part = around; part < named.stage.parts(); ++part)
          flown[part].add(flight.point.part == part ? seen : 0);
        const PathPoint q = random_point_of(named.stage, random, i % 2 ? near_bodies : reach);
        const auto connection = space->connect_through(p, q, random, statistics);
        const ScatteringMedium& medium = named.stage.medium_in(q.part);
        const double value =
            connection ? medium.mu_t() * connection->transmittance * connection->multiplicity /
                             (4 * pi * connection->spreading * density_of_points(q.x)) *
                             share(*space, q, *connection)
                       : 0;
        for (Part part = around; part < named.stage.parts(); ++part)
          connected[part].add(q.part == part ? value : 0);
      }
      for (Part k = around; k < named.stage.parts(); ++k) {
        CAPTURE(k);
        CAPTURE(flown[k].mean());
        CAPTURE(connected[k].mean());
        const double error = std::hypot(flown[k].error(), connected[k].error());
        CAPTURE(error);
        CHECK(std::abs(flown[k].mean() - connected[k].mean()) <= 4 * error);
        CHECK(error <= 0.06 * effort.errors * flown[k].mean() + 1e-3);
      }
    }
}

}  // namespace flatspeckle::grin::tests::test_connections_through_body
