#include <array>
#include <cmath>
#include <functional>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "bench/scenes/meshes.h"
#include "bench/scenes/random_fields.h"
#include "core/error.h"
#include "grin/rays/marching/trace.h"
#include "tests/grin/ray_tests.h"
#include "tests/grin/space_stages.h"
#include "tests/statistics.h"

namespace flatspeckle::grin::test_flight {

namespace {

using bench::cube_mesh;
using bench::random_direction;
using bench::random_point;
using bench::smooth;

const Sphere ball;
const Box box{{-1, -0.8, -1.2}, {0.9, 1, 1}};

Stage stage_of(const Surface& boundary, const ScatteringMedium& medium = {}) {
  return {.boundary = boundary, .medium = medium};
}
Stage with_body(const Surface& boundary, const Surface& body, const ScatteringMedium& around = {},
                const ScatteringMedium& in = {}) {
  return {.boundary = boundary, .medium = around, .bodies = {Body{body, in}}};
}

/// Checks that exp(-optical depth) of the flights' ends is uniform in (0, 1), with all below that
/// of the exit gathered there.
void check_depths(const std::vector<double>& survived, double depth_of_exit) {
  constexpr int bins = 30;
  std::vector<double> counts(bins), probabilities(bins);
  const double exit = std::exp(-depth_of_exit);
  for (const double u : survived) ++counts[std::min(bins - 1, static_cast<int>(u * bins))];
  for (int i = 0; i < bins; ++i) {
    const double low = 1.0 * i / bins, high = 1.0 * (i + 1) / bins;
    probabilities[i] =
        std::max(0.0, high - std::max(low, exit)) + (low <= exit && exit < high ? exit : 0);
  }
  flatspeckle::tests::check_chi_square(counts, probabilities);
}

/// Returns the exact optical depth of a straight ray segment.
double straight_depth(const ScatteringMedium& medium, const Vec3& x, const Vec3& d, double length) {
  double sum = 0;
  constexpr int steps = 4000;
  for (int i = 0; i < steps; ++i)
    sum += (medium.density ? (*medium.density)(x + (i + 0.5) / steps * length * d) : 1) / steps;
  return medium.mu_t() * length * sum;
}

void check_free_flights(const Space& space, const ScatteringMedium& medium, const Vec3& x,
                        const Vec3& d, const std::function<double(double)>& depth,
                        double ray_length, int flights) {
  std::vector<double> survived;
  RandomStream random(7, 90, 0);
  for (int i = 0; i < flights; ++i) {
    const Flight flight = space.fly({x}, d, random);
    REQUIRE(flight.end != Flight::End::lost);
    const bool left = flight.end == Flight::End::boundary;
    if (left) CHECK(flight.arc_length == doctest::Approx(ray_length).epsilon(1e-7));
    survived.push_back(std::exp(-depth(left ? ray_length : flight.arc_length)));
  }
  check_depths(survived, depth(ray_length));
  CHECK(medium.mu_s > 0);
}

}  // namespace

TEST_CASE("straight flights: ends on the boundary agree with sphere tracing") {
  const TriangleMesh cube = cube_mesh(0.8);
  const Surface surfaces[] = {ball, box, smooth(cube, 0.08)};
  const LinearRamp even{0.25, Vec3::Zero()};
  for (const Surface& boundary : surfaces) {
    const Space space(Homogeneous{0.25}, stage_of(boundary));
    RandomStream random(1, 91, 0);
    for (int i = 0; i < 300; ++i) {
      const Vec3 x = random_point(random, 0.75), d = random_direction(random);
      const Flight flight = space.fly({x}, d, random);
      FixedSteps<Leapfrog> steps{0.1};
      RayState ray{x, 1.25 * d};
      trace(even, {&boundary, 1}, {.max_arc_length = 10}, steps, ray);
      REQUIRE(flight.end == Flight::End::boundary);
      // both end a distance of 1e-10 before the surface, which a ray may meet at a glancing angle
      CHECK((flight.point.x - ray.x).norm() < 1e-7);
      CHECK(flight.optical_path == doctest::Approx(1.25 * flight.arc_length));
      CHECK(flight.spreading == doctest::Approx(flight.arc_length * flight.arc_length));
      CHECK(flight.direction == d);
    }
  }
}

TEST_CASE("straight crossings: a ray that has just left a surface does not meet it again") {
  RandomStream random(2, 91, 0);
  const Surface surfaces[] = {ball, box};
  for (const Surface& surface : surfaces) {
    for (int i = 0; i < 3000; ++i) {
      const Vec3 inside = random_point(random, 0.7), d = random_direction(random);
      const Vec3 x = inside + exit_distance(surface, inside, d) * d;
      const Vec3 n = normal(surface, x);
      CHECK(entry_distance(surface, x, d) == no_crossing);
      const Vec3 back = d - 2 * d.dot(n) * n;
      CHECK(exit_distance(surface, x, back) > 1e-9);
      CHECK(entry_distance(surface, x + 0.5 * d, -d) == doctest::Approx(0.5));
    }
  }
}

TEST_CASE(
    "free flights: optical depths are exponential, straight and curved, with and without a grid") {
  const Vec3 x(-0.5, 0.2, 0.1), d = Vec3(0.9, -0.2, 0.3).normalized();
  for (const bool gridded : {false, true}) {
    for (const double mu_s : {1.5, 20.0}) {
      ScatteringMedium medium{.mu_s = mu_s, .mu_a = 0.3};
      if (gridded) medium.density = tests::random_density(1);
      const Stage stage = stage_of(ball, medium);
      const double ray_length = exit_distance(ball, x, d);
      check_free_flights(
          Space(Homogeneous{0.1}, stage), medium, x, d,
          [&](double s) { return straight_depth(medium, x, d, s); }, ray_length, 6000);
      const auto check_curved = [&](const auto& field) {
        // through a grid by steps so small that rays end where closed forms do
        const auto curved = make_space(field, stage, {0.02, 8});
        // depth by small steps, tabulated
        RayState ray = start_ray(field, x, d);
        std::vector<double> arcs{0}, depths{0};
        while (ball.distance(ray.x) < 0) {
          const RayState before = ray;
          Sharma::step(field, ray, 5e-4);
          const double arc = ray.arc_length - before.arc_length;
          const Vec3 middle = (ray.x + before.x) / 2;
          arcs.push_back(ray.arc_length);
          depths.push_back(depths.back() +
                           medium.mu_t() * arc * (gridded ? (*medium.density)(middle) : 1));
        }
        const auto depth = [&](double s) {
          const auto i = std::min<std::size_t>(
              std::upper_bound(arcs.begin(), arcs.end(), s) - arcs.begin(), arcs.size() - 1);
          const double part = (s - arcs[i - 1]) / (arcs[i] - arcs[i - 1]);
          return depths[i - 1] + part * (depths[i] - depths[i - 1]);
        };
        RandomStream random(1, 1, 1);
        const auto clear = make_space(field, stage_of(ball), {0.02, 8});
        const double out = clear->fly({x}, d, random).arc_length;
        CHECK(std::abs(out - arcs.back()) < 1e-3);
        check_free_flights(*curved, medium, x, d, depth, out, 6000);
      };
      check_curved(Fisheye({.centre_excess = 0.8, .radius = 1.5}));
      check_curved(Luneburg({}));
    }
  }
}

TEST_CASE(
    "flights in absorbers: mean weights agree with Beer and Lambert, exactly or by ratio "
    "tracking") {
  const Vec3 x(-0.5, 0.2, 0.1), d = Vec3(0.9, -0.2, 0.3).normalized();
  ScatteringMedium medium{.mu_a = 1.7};
  const double ray_length = exit_distance(ball, x, d);
  for (const bool gridded : {false, true}) {
    if (gridded) medium.density = tests::random_density(3);
    const double expected = std::exp(-straight_depth(medium, x, d, ray_length));
    // a space that bends rays so weakly that they are straight
    const auto curved =
        make_space(LinearRamp{0, 1e-9 * Vec3::UnitX()}, stage_of(ball, medium), {0.1, 8});
    const Space straight(Homogeneous{0}, stage_of(ball, medium));
    const auto check_mean = [&](const auto& space, std::uint64_t seed) {
      RandomStream random(seed, 92, 0);
      double sum = 0, squares = 0;
      constexpr int flights = 20000;
      for (int i = 0; i < flights; ++i) {
        const Flight flight = space.fly({x}, d, random);
        REQUIRE(flight.end == Flight::End::boundary);
        CHECK(flight.optical_depth == 0);
        sum += flight.weight / flights;
        squares += flight.weight * flight.weight / flights;
      }
      const double error = std::sqrt(std::max(0.0, squares - sum * sum) / flights);
      CHECK(std::abs(sum - expected) < 4 * error + 1e-6);
      CHECK((error > 1e-6) == gridded);
    };
    check_mean(straight, 1);
    check_mean(*curved, 2);
  }
}

TEST_CASE(
    "curved flights in a Luneburg ball: position, direction, |J| and optical path agree with C27") {
  const auto space = make_space(Luneburg({}), stage_of(ball), {0.02, 8});
  const auto coarse = make_space(Luneburg({}), stage_of(ball, {.mu_s = 2}), {0.05, 8});
  RandomStream random(3, 91, 0);
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = random_point(random, 0.98), d = random_direction(random);
    const double n = std::sqrt(2 - x.squaredNorm());
    const tests::LuneburgRay exact{x, n * d};
    for (const Space* by : {space.get(), coarse.get()}) {
      const Flight flight = by->fly({x}, d, random);
      REQUIRE(flight.end != Flight::End::lost);
      // sigma of the nearest point of the exact ray: a search, then Newton's method
      double sigma = 0;
      for (int k = 1; k < 4000; ++k)
        if ((exact.x(k * 0.001) - flight.point.x).norm() < (exact.x(sigma) - flight.point.x).norm())
          sigma = k * 0.001;
      for (int k = 0; k < 20; ++k)
        sigma -=
            (exact.x(sigma) - flight.point.x).dot(exact.v(sigma)) / exact.v(sigma).squaredNorm();
      const double tolerance = by == space.get() ? 2e-7 : 1e-5;
      CHECK((exact.x(sigma) - flight.point.x).norm() < tolerance);
      CHECK((exact.v(sigma).normalized() - flight.direction).norm() < tolerance);
      CHECK(std::abs(exact.optical_path(sigma) - flight.optical_path) < tolerance);
      const double spreading = n * n * std::pow(std::sin(sigma), 2) *
                               std::abs(exact.v(0).normalized().dot(exact.v(sigma).normalized()));
      CHECK(std::abs(spreading - flight.spreading) < tolerance);
      if (flight.end == Flight::End::boundary) CHECK(std::abs(flight.point.x.norm() - 1) < 1e-10);
    }
  }
}

TEST_CASE("curved flights in a fisheye: |J| and angular momentum agree with C27") {
  const double a = 0.8;
  const Fisheye field({.centre_excess = 0.7, .radius = a});
  const auto space = make_space(field, stage_of(box, {.mu_s = 0.7}), {0.01, 8});
  RandomStream random(4, 91, 0);
  const double big = 1.7 * a / 2;
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = random_point(random, 0.75), d = random_direction(random);
    const Flight flight = space->fly({x}, d, random);
    REQUIRE(flight.end != Flight::End::lost);
    const double n = index(field, flight.point.x);
    const double exact = std::pow(big * std::sin(flight.optical_path / big) / n, 2);
    CHECK(std::abs(flight.spreading - exact) < 1e-6);
    const Vec3 before = x.cross(index(field, x) * d),
               after = flight.point.x.cross(n * flight.direction);
    CHECK((before - after).norm() < 1e-7);
    CHECK(space->index(flight.point) == doctest::Approx(n).epsilon(1e-14));
  }
}

TEST_CASE("reversed flights: reciprocity n_P^2 / |J_PQ| = n_Q^2 / |J_QP|") {
  RandomStream fields(5, 91, 0);
  const auto blobs = bench::random_blobs(fields, 0.2);
  const auto space = make_space(blobs, stage_of(ball), {0.01, 8});
  RandomStream random(6, 91, 0);
  for (int i = 0; i < 200; ++i) {
    const PathPoint p{random_point(random, 0.9)};
    const Flight out = space->fly(p, random_direction(random), random);
    const Flight across = space->fly(out.point, -out.direction, random);
    const Flight back = space->fly(across.point, -across.direction, random);
    REQUIRE(back.end == Flight::End::boundary);
    CHECK((back.point.x - out.point.x).norm() < 1e-6);
    const double n_p = space->index(across.point), n_q = space->index(back.point);
    CHECK(across.spreading / (n_q * n_q) ==
          doctest::Approx(back.spreading / (n_p * n_p)).epsilon(1e-5));
    CHECK(across.optical_path == doctest::Approx(back.optical_path).epsilon(1e-8));
  }
}

TEST_CASE("flights through a glass sphere: agree with Fresnel, Snell and angular momentum") {
  const double n = 1.5;
  const Space space(Homogeneous{n - 1}, with_body(Sphere{Vec3::Zero(), 3}, ball));
  for (const double impact : {0.1, 0.6, 0.95}) {
    const Vec3 x(impact, 0, -2);
    const double at = std::asin(impact), in = std::asin(impact / n);
    const Interface face(Vec3(std::sin(at), 0, std::cos(at)), Vec3::UnitZ(), 0, n - 1);
    const double r = face.reflectance();
    // paths of k chords in the ball: probability r for k = 0, else (1-r)^2 r^(k-1), with a known
    // turn
    std::array<double, 4> seen{};
    RandomStream random(7, 91, 0);
    constexpr int flights = 40000;
    for (int i = 0; i < flights; ++i) {
      const Flight flight = space.fly({x}, Vec3::UnitZ(), random);
      REQUIRE(flight.end == Flight::End::boundary);
      CHECK(flight.crosses_body);
      CHECK(flight.crossings.count ==
            static_cast<int>(std::round((flight.arc_length - (2 - std::cos(at)) -
                                         (std::sqrt(9 - impact * impact) - std::cos(at))) /
                                        (2 * std::cos(in)))) +
                1);
      CHECK(flight.weight == 1);
      CHECK(std::abs(flight.point.x.cross(flight.direction)[1] - x.cross(Vec3::UnitZ())[1]) <
            1e-12);
      const double before = 2 - std::cos(at), inside = 2 * std::cos(in);
      const double after = [&] { return std::sqrt(9 - impact * impact) - std::cos(at); }();
      const double chords = (flight.arc_length - before - after) / inside;
      const int k = static_cast<int>(std::round(chords));
      CHECK(std::abs(chords - k) < 1e-9);
      CHECK(flight.optical_path == doctest::Approx(before + after + n * k * inside));
      const double turn = k == 0 ? std::numbers::pi - 2 * at
                                 : 2 * (at - in) + (k - 1) * (std::numbers::pi - 2 * in);
      CHECK(flight.direction[2] == doctest::Approx(std::cos(turn)).epsilon(1e-9));
      if (k < 4) ++seen[k];
    }
    for (int k = 0; k < 4; ++k) {
      const double probability = k == 0 ? r : (1 - r) * (1 - r) * std::pow(r, k - 1);
      CHECK(std::abs(seen[k] / flights - probability) <
            4 * std::sqrt(probability / flights) + 1e-4);
    }
  }
}

TEST_CASE("flights in a glass ball: lost if and only if total reflection traps them") {
  const Space space(Homogeneous{0.5}, with_body(Sphere{Vec3::Zero(), 3}, ball));
  RandomStream random(8, 91, 0);
  const double free = 1 / 1.5;
  for (const double radius : {0.5, 0.9}) {
    for (int i = 0; i < 200; ++i) {
      const Vec3 x = radius * random_direction(random), d = random_direction(random);
      const Flight flight = space.fly({x, Part{1}}, d, random);
      const double momentum = x.cross(d).norm();
      CHECK((flight.end == Flight::End::lost) == (momentum > free));
      if (momentum < free) CHECK(flight.point.part == around);
    }
  }
}

TEST_CASE("flights through a mesh of a cube: agree with the cube") {
  const Box cube{Vec3::Constant(-0.8), Vec3::Constant(0.8)};
  const Space exact(Homogeneous{0}, with_body(Sphere{Vec3::Zero(), 3}, cube));
  const Space mesh(Homogeneous{0},
                   with_body(Sphere{Vec3::Zero(), 3}, smooth(cube_mesh(0.8), 0.04)));
  RandomStream random(9, 91, 0);
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = 2.5 * random_direction(random), d = (random_point(random, 1) - x).normalized();
    const Flight a = exact.fly({x}, d, random), b = mesh.fly({x}, d, random);
    CHECK((a.point.x - b.point.x).norm() < 1e-6);
    if (a.crosses_body == b.crosses_body) continue;
    // the ray passes an edge by less than a cell
    CHECK(entry_distance(Box{Vec3::Constant(-0.76), Vec3::Constant(0.76)}, x, d) == no_crossing);
  }
}

TEST_CASE("Luneburg body in a box: a beam is focused at the far pole, at any step") {
  for (const double step : {0.05, 0.02}) {
    const auto space =
        make_space(Luneburg({}), with_body(Box{{-2, -2, -2}, {2, 2, 2}}, ball), {step, 10});
    RandomStream random(10, 91, 0);
    for (int i = 0; i < 100; ++i) {
      const double rho = 0.95 * std::sqrt(random.uniform()), turn = 6.28 * random.uniform();
      const Vec3 x(rho * std::cos(turn), rho * std::sin(turn), -2);
      const Flight flight = space->fly({x}, Vec3::UnitZ(), random);
      REQUIRE(flight.end == Flight::End::boundary);
      CHECK(flight.crosses_body);
      CHECK(flight.point.part == around);
      // beyond the pole rays are straight
      const Vec3 from = flight.point.x - Vec3::UnitZ();
      CHECK((from.normalized() - flight.direction).norm() < (step > 0.03 ? 1e-5 : 1e-6));
      CHECK(std::abs(flight.optical_path - (1 + std::numbers::pi / 2 + 1 + from.norm())) < 1e-5);
    }
  }
}

TEST_CASE("flights: lost where they are too long or the index is not defined") {
  RandomStream random(11, 91, 0);
  const auto brief = make_space(Fisheye({}), stage_of(ball), {0.05, 0.3});
  CHECK(brief->fly({Vec3::Zero()}, Vec3::UnitX(), random).end == Flight::End::lost);
  CHECK(brief->fly({0.8 * Vec3::UnitX()}, Vec3::UnitX(), random).end == Flight::End::boundary);
  const auto dark = make_space(LinearRamp{0, Vec3(0, 0, -2)}, stage_of(ball), {0.01, 8});
  CHECK(dark->fly({0.8 * Vec3::UnitZ()}, Vec3::UnitX(), random).end == Flight::End::lost);
  const auto guide =
      make_space(ParabolicGuide({.axis_excess = 0.1, .alpha = 2}), stage_of(ball), {0.01, 8});
  CHECK(guide->fly({0.9 * Vec3::UnitX()}, Vec3::UnitZ(), random).end == Flight::End::lost);
}

TEST_CASE("flights without spreading: all else agrees with flights with it") {
  const Stage stage = stage_of(ball, {.mu_s = 1});
  const AnyIndexField fields[] = {Luneburg({}), Fisheye({1, 1.5})};
  for (const AnyIndexField& field : fields) {
    const auto with = make_space(field, stage, {0.05, 8, Spreading::all});
    const auto without = make_space(field, stage, {0.05, 8, Spreading::none});
    const auto last = make_space(field, stage, {0.05, 8, Spreading::to_boundary});
    for (int i = 0; i < 50; ++i) {
      RandomStream a(12, 91, i), b(12, 91, i), c(12, 91, i);
      const Vec3 x(0.1, 0.2, 0.3), d = random_direction(a);
      random_direction(b);
      random_direction(c);
      const Flight one = with->fly({x}, d, a), two = without->fly({x}, d, b),
                   three = last->fly({x}, d, c);
      CHECK((one.point.x - two.point.x).norm() < 1e-14);
      CHECK((one.point.x - three.point.x).norm() < 1e-14);
      CHECK(one.spreading > 0);
      CHECK(two.spreading == 0);
      CHECK(three.spreading == (one.end == Flight::End::boundary ? one.spreading : 0));
      CHECK(a.uniform() == c.uniform());
    }
  }
}

TEST_CASE("frozen fields: a wave at that phase; other fields are rejected") {
  const StandingWave wave(0.3, 0.05, 0, 9, 40);
  const Stage stage = stage_of(ball);
  const auto space = make_space(wave, stage, {0.02, 8});
  const auto frozen = space->frozen(1.1),
             exact = make_space(wave.frozen(std::cos(1.1)), stage, {0.02, 8});
  RandomStream random(13, 91, 0);
  const Vec3 x(0.3, -0.2, 0.1), d = random_direction(random);
  CHECK(frozen->index({x}) == exact->index({x}));
  CHECK(frozen->fly({x}, d, random).point.x == exact->fly({x}, d, random).point.x);
  CHECK_THROWS_AS(make_space(Fisheye({}), stage, {0.1, 8})->frozen(1), InputError);
}

}  // namespace flatspeckle::grin::test_flight
