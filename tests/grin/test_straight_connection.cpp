#include <cmath>
#include <map>

#include <doctest/doctest.h>

#include "bench/oracles/harmonic_ball.h"
#include "bench/scenes/random_fields.h"
#include "grin/rays/connections/connection_solver.h"
#include "tests/grin/space_stages.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_straight_connection {

namespace {

using bench::random_direction;
using bench::random_point;
using flatspeckle::tests::is_night;

const Sphere ball;

/// Mean and standard error.
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

/// Checks the fraction of flights from p that collide in each octant about p, by flights and by
/// connections to uniform points. The density of collisions at q is the sum over curves of
/// mu_t(q) T / (4 pi |J|).
void check_flights_against_connections(const Space& space, const PathPoint& p,
                                       const ScatteringMedium& medium, int samples) {
  const auto octant = [&](const Vec3& x) {
    const Vec3 d = x - p.x;
    return (d[0] > 0) + 2 * (d[1] > 0) + 4 * (d[2] > 0);
  };
  std::map<int, Mean> flown, connected;
  ConnectionStatistics statistics;
  RandomStream random(3, 95, 0);
  for (int i = 0; i < samples; ++i) {
    const Flight flight = space.fly(p, random_direction(random), random);
    // rays that circle for longer than max_length are lost in both
    for (int k = 0; k < 8; ++k)
      flown[k].add(flight.end == Flight::End::collision && octant(flight.point.x) == k);
    // uniform along a line from p in a random direction, to cancel the 1/|J| of near points
    const Vec3 d = random_direction(random);
    const double far = exit_distance(ball, p.x, d), r = far * random.uniform();
    const PathPoint q{p.x + r * d, p.part};
    const auto connection = space.connect(p, q, random, statistics);
    const double rho = medium.density ? (*medium.density)(q.x) : 1;
    const double value = connection
                             ? medium.mu_t() * rho * connection->transmittance *
                                   connection->multiplicity / connection->spreading * r * r * far
                             : 0;
    for (int k = 0; k < 8; ++k) connected[k].add(octant(q.x) == k ? value : 0);
  }
  for (int k = 0; k < 8; ++k) {
    CAPTURE(k);
    const double error = std::hypot(flown[k].error(), connected[k].error());
    CHECK(flown[k].mean() > 8 * error);
    CHECK(std::abs(flown[k].mean() - connected[k].mean()) < 4 * error);
  }
}

}  // namespace

TEST_CASE("reference extinction: from the density inside the part") {
  // 1 in the body, 3 around it in the stage, 100 beyond
  const Sphere core{Vec3::Zero(), 1};
  const Box box{Vec3::Constant(-2), Vec3::Constant(2)};
  const FieldGrid grid{Vec3::Constant(-5), Vec3::Constant(0.125), {81, 81, 81}};
  std::vector<double> density;
  for (int i = 0; i < 81 * 81 * 81; ++i) {
    const Vec3 x = grid.origin + 0.125 * Vec3(i / 81 / 81, i / 81 % 81, i % 81);
    density.push_back(core.distance(x) < 0.25 ? 1 : box.distance(x) < 0.25 ? 3 : 100);
  }
  const ScatteringMedium medium{2, 0, {}, std::make_shared<DensityGrid>(grid, density)};
  const Stage stage{box, medium, {Body{core, medium}}};
  const Space space(Homogeneous{0}, stage);
  RandomStream random(2, 94, 0);
  ConnectionStatistics statistics;
  const auto depth = [&](const Vec3& p, const Vec3& q, Part part) {
    return space.connect({p, part}, {q, part}, random, statistics)->optical_depth;
  };
  CHECK(depth({0, 0, 0}, {0.5, 0, 0}, Part{1}) == doctest::Approx(2 * 1 * 0.5));
  CHECK(depth({1.5, 0, 0}, {1.5, 1, 0}, around) == doctest::Approx(2 * 3 * 1).epsilon(0.1));
}

TEST_CASE("straight connections: closed form, none through a body or to another part") {
  const Stage stage{.boundary = Sphere{Vec3::Zero(), 3},
                    .medium = {.mu_s = 0.4, .mu_a = 0.1},
                    .bodies = {Body{ball, {.mu_a = 0.7}}},
                    .excess_around = 0.2};
  const Space space(Homogeneous{0.5}, stage);
  RandomStream random(1, 96, 0);
  ConnectionStatistics statistics;
  int blocked = 0;
  for (int i = 0; i < 2000; ++i) {
    const PathPoint p{(1 + 1.9 * random.uniform()) * random_direction(random)};
    const PathPoint q{(1 + 1.9 * random.uniform()) * random_direction(random)};
    const Vec3 chord = q.x - p.x;
    const double t = std::clamp(-p.x.dot(chord) / chord.squaredNorm(), 0.0, 1.0);
    const bool meets = (p.x + t * chord).norm() < 1;
    const auto connection = space.connect(p, q, random, statistics);
    REQUIRE(connection.has_value() == !meets);
    blocked += meets;
    if (!connection) continue;
    CHECK(connection->spreading == doctest::Approx(chord.squaredNorm()));
    CHECK(connection->optical_path == doctest::Approx(1.2 * chord.norm()));
    CHECK(connection->transmittance == doctest::Approx(std::exp(-0.5 * chord.norm())));
    CHECK(connection->optical_depth == doctest::Approx(0.5 * chord.norm()));
    CHECK(connection->multiplicity == 1);
    CHECK((connection->start_direction - chord.normalized()).norm() < 1e-14);
    CHECK(!space.connect(p, {0.3 * q.x, Part{1}}, random, statistics));
    const auto within =
        space.connect({0.3 * p.x, Part{1}}, {0.3 * q.x, Part{1}}, random, statistics);
    REQUIRE(within);
    CHECK(within->optical_path == doctest::Approx(1.5 * 0.3 * chord.norm()));
    CHECK(within->transmittance == doctest::Approx(std::exp(-0.7 * 0.3 * chord.norm())));
    CHECK(within->optical_depth == 0);
  }
  CHECK(blocked > 200);
  CHECK(blocked < 1800);
  CHECK(!space.connect({Vec3::UnitX() * 2}, {Vec3::UnitX() * 2}, random, statistics));
}

TEST_CASE("curved flights: agree with the connection of their endpoints") {
  RandomStream fields(2, 96, 0);
  const Stage stage{.boundary = ball, .medium = {.mu_s = 2, .mu_a = 0.5}};
  const AnyIndexField all[] = {bench::random_blobs(fields, 0.03), Luneburg({}),
                               StandingWave(0.33, 1e-3, 0, 20, 40),
                               ParabolicGuide({.axis_excess = 0.5, .alpha = 0.6})};
  for (const AnyIndexField& field : all) {
    const auto space = make_space(field, stage, {0.01, 8});
    RandomStream random(4, 96, 0);
    ConnectionStatistics statistics;
    int same = 0;
    for (int i = 0; i < 100; ++i) {
      const PathPoint p{random_point(random, 0.9)};
      const Flight flight = space->fly(p, random_direction(random), random);
      const auto connection = space->connect(p, flight.point, random, statistics);
      if (!connection) continue;
      if ((connection->start_direction - flight.start_direction).norm() > 1e-3)
        continue;  // another curve
      ++same;
      CHECK((connection->start_direction - flight.start_direction).norm() < 1e-6);
      CHECK((connection->end_direction - flight.direction).norm() < 1e-6);
      CHECK(std::abs(connection->spreading / flight.spreading - 1) < 1e-6);
      CHECK(std::abs(connection->optical_path - flight.optical_path) < 1e-7);
      CHECK(std::abs(connection->optical_depth - flight.optical_depth) < 1e-7);
      CHECK(connection->transmittance ==
            doctest::Approx(std::exp(-2.5 * flight.arc_length)).epsilon(1e-6));
      const auto back = space->connect(flight.point, p, random, statistics);
      if (!back || (back->end_direction + connection->start_direction).norm() > 1e-3) continue;
      const double n_p = space->index(p), n_q = space->index(flight.point);
      CHECK(n_q * n_q * connection->spreading ==
            doctest::Approx(n_p * n_p * back->spreading).epsilon(1e-6));
    }
    CHECK(same > 90);
  }
}

TEST_CASE("collisions of light from a point: densities of flights and connections agree") {
  ScatteringMedium medium{.mu_s = 0.8, .mu_a = 0.1};
  const PathPoint p{Vec3(0.5, -0.2, 0.3)};
  for (const bool gridded : {false, true}) {
    if (gridded) medium.density = tests::random_density(5);
    const Stage stage{.boundary = ball, .medium = medium};
    check_flights_against_connections(Space(Homogeneous{0.1}, stage), p, medium, 20000);
    // the focus of light from p is outside: with one inside, 1/|J| has infinite variance
    const auto fisheye = make_space(Fisheye({.centre_excess = 1, .radius = 1.1}), stage, {0.05, 8});
    check_flights_against_connections(*fisheye, p, medium, 8000);
  }
}

TEST_CASE("collisions in a body: densities of flights and connections agree") {
  const ScatteringMedium medium{.mu_s = 1.5};
  const Stage stage{.boundary = Box{{-2, -2, -2}, {2, 2, 2}}, .bodies = {Body{ball, medium}}};
  const auto space = make_space(Luneburg({}), stage, {0.05, 10});
  check_flights_against_connections(*space, {Vec3(0.4, 0.3, -0.5), Part{1}}, medium, 8000);
  // around the body rays are straight, and no solver runs
  ConnectionStatistics statistics;
  RandomStream random(5, 96, 0);
  const auto connection =
      space->connect({Vec3(1.5, 1.5, 0)}, {Vec3(1.5, -1, 0.5)}, random, statistics);
  REQUIRE(connection);
  CHECK(connection->spreading == doctest::Approx(6.5));
  CHECK(!space->connect({Vec3(1.5, 0, 0)}, {Vec3(-1.5, 0, 0)}, random, statistics));
  CHECK(statistics.trials() == 0);
}

TEST_CASE("curved connections: none begin or end outside the boundary, however short") {
  // rays bend towards the middle of a fisheye: between points of a face they run outside
  const Stage stage{.boundary = Box{{-1, -1, -1}, {1, 1, 1}}};
  const auto space = make_space(Fisheye({.centre_excess = 1, .radius = 2}), stage, {0.2, 8});
  ConnectionStatistics statistics;
  RandomStream random(8, 96, 0);
  const PathPoint p{Vec3(1, -0.05, 0.1)}, q{Vec3(1, 0.05, 0.05)}, inner{Vec3(0.95, 0.05, 0.05)};
  for (int i = 0; i < 20; ++i) {
    CHECK(!space->connect(p, q, random, statistics));
    CHECK(space->connect(p, inner, random, statistics));
    CHECK(space->connect(inner, q, random, statistics));
  }
}

TEST_CASE("curved connections: none run outside the boundary within a step") {
  // one step; the curve bulges by alpha^2 rho z^2 / (8 beta^2) at the most
  const Stage stage{.boundary = Box{{-0.9, -0.9, 0}, {0.9, 0.9, 4}}};
  const auto space = make_space(ParabolicGuide({0.6, 0.5}), stage, {2, 40});
  ConnectionStatistics statistics;
  RandomStream random(8, 97, 0);
  const auto is_connected = [&](double rho) {
    return space->connect({Vec3(rho, 0, 1)}, {Vec3(rho, 0, 2)}, random, statistics).has_value();
  };
  for (int i = 0; i < 20; ++i) {
    CHECK(is_connected(0.87));
    CHECK(!is_connected(0.895));
  }
}

TEST_CASE("connections in a homogeneous field: closed form, without trials") {
  const Stage stage{.boundary = ball, .medium = {.mu_s = 1}};
  const auto space = make_space(Homogeneous{0.4}, stage, {0.1, 1e-3});
  const Space straight(Homogeneous{0.4}, stage);
  ConnectionStatistics statistics;
  RandomStream a(6, 96, 0), b(6, 96, 0);
  for (int i = 0; i < 100; ++i) {
    const PathPoint p{random_point(a, 1)}, q{random_point(a, 1)};
    const Vec3 d = random_direction(a);
    for (int k = 0; k < 100; ++k) random_point(b, 1);
    const auto connection = space->connect(p, q, a, statistics);
    REQUIRE(connection);
    CHECK(connection->optical_path == doctest::Approx(1.4 * (q.x - p.x).norm()).epsilon(1e-14));
    const Flight flight = space->fly(p, d, a);
    CHECK(flight.end != Flight::End::lost);
  }
  CHECK(statistics.trials() == 0);
}

TEST_CASE(
    "connections that try the chord first: number and sum of curves agree with the closed form") {
  // two or more curves, which wind about the centre
  const oracles::HarmonicBall field{oracles::HarmonicProfile{}};
  const ConnectionOptions options{.step = 0.02, .max_length = 6, .count_caustics = false};
  const Vec3 from(0.5, 0.1, -0.2), to(-0.3, 0.6, 0.4);
  const ConnectionTrial trial(field, Inside<bench::Ball>{{1.41}}, from, to, options);
  RandomStream random(7, 96, 0);
  ConnectionStatistics statistics;
  double exact = 0;
  int curves = 0;
  for (const oracles::HarmonicCurve& curve : oracles::harmonic_curves(from, to, 20)) {
    if (curve.arc_length() > options.max_length) continue;
    exact += 1 / curve.spreading();
    ++curves;
  }
  REQUIRE(curves > 1);
  Mean number, spread;
  for (int i = 0; i < (is_night ? 12000 : 9000); ++i) {
    const auto found = connect_chord_first(trial, random, statistics);
    number.add(found.multiplicity);
    spread.add(found.curve ? found.multiplicity / found.curve->spreading : 0);
  }
  CHECK(number.error() < 0.1 * curves);
  CHECK(std::abs(number.mean() - curves) < 4 * number.error());
  CHECK(std::abs(spread.mean() - exact) < 4 * spread.error());
}

}  // namespace flatspeckle::grin::test_straight_connection
