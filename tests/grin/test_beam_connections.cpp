#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "bench/scenes/furnaces.h"
#include "bench/scenes/random_fields.h"
#include "grin/media/geometry/frame.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "tests/grin/render_tests.h"
#include "tests/grin/space_stages.h"

namespace flatspeckle::grin::tests::test_beam_connections {

namespace {

using bench::scene_in;
using std::numbers::pi;

const Box stage_box{Vec3::Constant(-2), Vec3::Constant(2)};

struct BentSpace {
  std::string name;
  Stage stage;
  AnyIndexField field;
};

std::vector<BentSpace> bent_spaces() {
  const Surface ball = Sphere{Vec3(0.1, 0, 0), 1};
  const Surface block = Box{{-0.9, -0.8, -1}, {0.7, 1, 0.9}};
  const auto with = [&](const Surface& body) {
    return Stage{stage_box, {}, {Body{body, {}}}, 0.1};
  };
  RandomStream random(5, 98, 0);
  return {
      {"glass ball", with(ball), Homogeneous{0.5}},
      {"bubble", with(ball), Homogeneous{-0.2}},
      {"glass block", with(block), Homogeneous{0.5}},
      {"Luneburg ball", Stage{stage_box, {}, {Body{Sphere{}, {}}}}, Luneburg({})},
      {"fisheye block", with(block), Fisheye({.centre_excess = 0.6, .radius = 2})},
      {"parabolic stage", Stage{stage_box, {}}, ParabolicGuide({.axis_excess = 0.5, .alpha = 0.3})},
      {"blobs in the stage", Stage{stage_box, {}}, bench::random_blobs(random, 0.2)}};
}

template <class Use>
void with_space(const BentSpace& bent, const Use& use) {
  if (const auto* homogeneous = std::get_if<Homogeneous>(&bent.field))
    use(Space(Homogeneous{homogeneous->n_excess}, bent.stage));
  use(*make_space(bent.field, bent.stage, {0.02, 40}));
}

/// Returns a flight with the same end and interface crossings as `other`, where reflections and
/// refractions are drawn at random; nullopt if 2000 draws find none.
std::optional<Flight> alike(const Space& space, const PathPoint& from, const Vec3& direction,
                            const Flight& other, RandomStream& random) {
  for (int i = 0; i < 2000; ++i) {
    const Flight flight = space.fly(from, direction, random);
    if (flight.end == other.end && flight.crossings == other.crossings) return flight;
  }
  return std::nullopt;
}

/// Returns the cross section of a narrow beam at a flight's end over that at its start, from
/// differences of neighbouring flights.
std::optional<double> thinning_by_differences(const Space& space, const PathPoint& from,
                                              const Flight& flight, RandomStream& random) {
  constexpr double apart = 1e-5;
  const Frame start = frame_across(flight.start_direction), end = frame_across(flight.direction);
  Mat2 map;
  for (int axis = 0; axis < 2; ++axis) {
    const auto beside = [&](double by) {
      return alike(space, {from.x + by * start.col(axis), from.part}, flight.start_direction,
                   flight, random);
    };
    const auto one = beside(apart), other = beside(-apart);
    if (!one || !other) return std::nullopt;
    map.col(axis) = end.transpose() * (one->point.x - other->point.x) / (2 * apart);
  }
  return std::abs(map.determinant());
}

}  // namespace

TEST_CASE(
    "beam connection: place, optical path, transmittance and thinning agree with the flight from "
    "the beam") {
  for (const BentSpace& bent : bent_spaces())
    with_space(bent, [&](const auto& space) {
      CAPTURE(bent.name);
      RandomStream random(3, 98, 0);
      int compared = 0;
      for (int i = 0; i < 60; ++i) {
        const ParallelLight light{Vec3(-1.7, 0.1, 0),
                                  Vec3(1, 0.1 * (random.uniform() - 0.5), 0.05).normalized()};
        const Frame across = frame_across(light.direction);
        const PathPoint from{light.x + 0.9 * (2 * random.uniform() - 1) * across.col(0) +
                             0.9 * (2 * random.uniform() - 1) * across.col(1)};
        const Flight flight = space.fly(from, light.direction, random);
        if (flight.end != Flight::End::boundary || flight.crossings.count > 3) continue;
        const auto thinning = thinning_by_differences(space, from, flight, random);
        if (!thinning || *thinning < 1e-3) continue;
        const auto connection = space.beam_connection(flight.point, light, -flight.direction,
                                                      flight.crossings.reversed(), random);
        REQUIRE(connection);
        ++compared;
        CHECK((connection->place - from.x).norm() < 1e-4);
        CHECK(connection->optical_path == doctest::Approx(flight.optical_path).epsilon(1e-5));
        CHECK(connection->transmittance ==
              doctest::Approx(std::exp(-flight.optical_depth)).epsilon(1e-4));
        CHECK(connection->thinning == doctest::Approx(*thinning).epsilon(2e-3));
      }
      CHECK(compared > 15);
    });
}

namespace {

/// Ray along +z that leaves a glass ball of radius 1 about the origin (-1 inner reflections:
/// reflected off the ball), in a plane through the axis, from the angles of incidence and
/// refraction alone. A point (rho, z) of this plane has the offset `beside` from it and the
/// distance `ahead` from its exit.
struct Pass {
  double beside, ahead;
  double rho_direction, z_direction;
};
Pass pass_ball(double impact, double index, int inner_reflections, double rho, double z) {
  const double incidence = std::asin(impact), refraction = std::asin(impact / index);
  // angle of the exit from -z; the ray leaves at its angle of incidence
  const double angle = incidence + (inner_reflections + 1) * (pi - 2 * refraction);
  const double x_rho = std::sin(angle), x_z = -std::cos(angle);
  const double d_rho = std::cos(incidence) * x_rho + std::sin(incidence) * std::cos(angle);
  const double d_z = std::cos(incidence) * x_z + std::sin(incidence) * std::sin(angle);
  return {(rho - x_rho) * d_z - (z - x_z) * d_rho, (rho - x_rho) * d_rho + (z - x_z) * d_z, d_rho,
          d_z};
}

double reflected(double impact, double index) {
  const double incidence = std::asin(impact), refraction = std::asin(impact / index);
  const double c1 = std::cos(incidence), c2 = std::cos(refraction);
  const double s = (c1 - index * c2) / (c1 + index * c2), p = (index * c1 - c2) / (index * c1 + c2);
  return (s * s + p * p) / 2;
}

/// Calls use(irradiance, rho and z of its direction) for each path from a beam of irradiance 1 to
/// the point (rho, z) by way of the ball. The irradiance is on a plane across the path; rho of the
/// direction has the sign of the point's.
void for_each_glint(double index, double rho, double z,
                    const std::function<void(double, double, double)>& use) {
  const int nodes = is_night ? 20000 : 5000;
  for (int k = -1; k <= 6; ++k)
    for (const double side : {1.0, -1.0}) {
      const auto at = [&](double b) { return pass_ball(b, index, k, side * rho, z); };
      for (int i = 0; i + 1 < nodes; ++i) {
        double low = (i + 0.5) / nodes, high = (i + 1.5) / nodes;
        if ((at(low).beside > 0) == (at(high).beside > 0)) continue;
        for (int step = 0; step < 40; ++step) {
          const double middle = (low + high) / 2;
          ((at(middle).beside > 0) == (at(low).beside > 0) ? low : high) = middle;
        }
        if (!(at(low).ahead > 0)) continue;
        constexpr double apart = 1e-6;
        const double derivative = (at(low + apart).beside - at(low - apart).beside) / (2 * apart);
        const double r = reflected(low, index);
        const double light = k < 0 ? r : (1 - r) * (1 - r) * std::pow(r, k);
        use(light * low / (rho * std::abs(derivative)), side * at(low).rho_direction,
            at(low).z_direction);
      }
    }
}

constexpr double glass = 1.5;
RenderScene glints(const Vec3& camera_at, double lens_radius) {
  const Stage stage{stage_box, {}, {Body{Sphere{}, {}}}};
  Camera camera{camera_at, -Vec3::UnitX(), Vec3::UnitY(), 2.0, {1, 1}, lens_radius, 2};
  return scene_in(Homogeneous{glass - 1}, stage,
                  BeamLight{Vec3(0, 0, -1.9), Vec3::UnitZ(), 1.1, pi * 1.1 * 1.1}, camera);
}

/// Returns the pixel of a camera at `x`, in the plane x = 2 and facing -x, from closed-form rays
/// through the ball.
double expected_picture(const Vec3& x) {
  const double half = std::tan(1.0), rho = std::hypot(x[0], x[1]);
  double sum = 0;
  for_each_glint(glass, rho, x[2], [&](double irradiance, double d_rho, double d_z) {
    const Vec3 seen = -Vec3(d_rho * x[0] / rho, d_rho * x[1] / rho, d_z);
    const double cosine = -seen[0];
    if (!(cosine > 0) || std::abs(seen[1]) > half * cosine || std::abs(seen[2]) > half * cosine)
      return;
    sum += irradiance / (cosine * cosine * cosine);
  });
  return sum / (4 * half * half);
}

}  // namespace

TEST_CASE(
    "connections to a beam behind a glass ball: irradiance agrees with sums over impact "
    "parameters") {
  const Stage stage{stage_box, {}, {Body{Sphere{}, {}}}};
  const auto check = [&](const auto& space, std::span<const BeamSeed> seeds) {
    RandomStream random(8, 98, 0);
    ConnectionStatistics statistics;
    for (const Vec3& x : {Vec3(1.9, 0.3, 0.5), Vec3(1.2, 0, 1.8), Vec3(-0.3, 0.2, 1.9)}) {
      double expected = 0;
      const double rho = std::hypot(x[0], x[1]);
      for_each_glint(glass, rho, x[2], [&](double light, double, double) { expected += light; });
      constexpr int draws = 20000;
      double sum = 0, squares = 0;
      for (int i = 0; i < draws; ++i) {
        double value = 0;
        for (const BeamConnection& connection : space.connections_to_beam(
                 {x}, {Vec3(0, 0, -1.9), Vec3::UnitZ()}, seeds, random, statistics))
          if (connection.crossings.count > 0)
            value += connection.transmittance / connection.thinning * connection.multiplicity;
        sum += value;
        squares += value * value;
      }
      const double mean = sum / draws;
      const double error = std::sqrt((squares / draws - mean * mean) / draws);
      CAPTURE(x.transpose());
      CAPTURE(expected);
      CAPTURE(mean);
      CAPTURE(seeds.size());
      CHECK(std::abs(mean - expected) < 4 * error);
      CHECK(error < 0.15 * expected);
    }
  };
  InterfaceCrossings through;
  through.add(false);
  through.add(false);
  InterfaceCrossings off;
  off.add(true);
  const BeamSeed seeds[] = {{-Vec3::UnitX(), off, Vec3::UnitX()},
                            {-Vec3::UnitX(), through, Vec3::UnitX()},
                            {-Vec3::UnitZ(), through, Vec3::UnitZ()}};
  for (const std::span<const BeamSeed> some :
       {std::span<const BeamSeed>(), std::span<const BeamSeed>(seeds)}) {
    // by day, each kind of space and of search once
    if (is_night || some.empty()) check(Space(Homogeneous{glass - 1}, stage), some);
    if (is_night || !some.empty())
      check(*make_space(Homogeneous{glass - 1}, stage, {0.1, 40}), some);
  }
}

namespace {

const Vec3 lens_at(2, 0.3, 0.4);

void check_glints(double lens_radius, double expected, double expected_error) {
  const Vec3 at = lens_radius > 0 ? lens_at : Vec3(lens_at - 1e-9 * Vec3::UnitX());
  const Rendered result = rendered(glints(at, lens_radius), RenderMethod::bidirectional,
                                   is_night          ? 4e5
                                   : lens_radius > 1 ? 2e5
                                                     : 2e4);
  CAPTURE(lens_radius);
  CHECK(std::abs(result.value() - expected) <
        4 * std::hypot(result.error(), expected_error) + 1e-5 * expected);
  CHECK(result.error() < 0.03 * expected);
}

}  // namespace

TEST_CASE(
    "glints of a beam in a glass ball: pinhole and small lens agree with sums over impact "
    "parameters") {
  check_glints(0, expected_picture(lens_at), 0);
  constexpr double radius = 0.02;
  double sum = 0;
  constexpr int spokes = 6;
  for (int i = 0; i < spokes; ++i) {  // exact for integrands quadratic over the lens
    const double t = 2 * pi * i / spokes;
    sum += expected_picture(lens_at + radius * std::sqrt(0.5) * Vec3(0, std::cos(t), std::sin(t)));
  }
  check_glints(radius, sum / spokes, 0);
}

TEST_CASE("glints of a beam in a glass ball: a wide lens agrees with ray tracing from the beam") {
  const RenderScene scene = glints(lens_at, 1.2);
  const Space space(Homogeneous{glass - 1}, scene.stage);
  const StageLights lights(scene.lights, scene.stage, [](const PathPoint&) { return 1.0; });
  const SensorEnd lens(scene.sensors[0], scene.stage);
  RandomStream random(9, 98, 0);
  const int rays = is_night ? 1000000 : 400000;
  double sum = 0, squares = 0;
  for (int i = 0; i < rays; ++i) {
    const EndPosition from = lights.beam_position(0.5, random.uniform(), random.uniform());
    const Flight flight = space.fly(from.point, from.inward, random);
    if (flight.end == Flight::End::lost) continue;
    lens.hit(space, flight.point.x, flight.direction, [&](const EndHit& hit) {
      const double value = hit.value * lights.beam_power();
      sum += value;
      squares += value * value;
    });
  }
  check_glints(1.2, sum / rays, std::sqrt(squares) / rays);
}

TEST_CASE(
    "pinhole in a beam: irradiance agrees with the closed form, in fog within bounds of Beer and "
    "Lambert") {
  const ScatteringMedium fog{.mu_s = 0.1, .mu_a = 0.2};
  const Vec3 at(0.3, 0.2, 0.5);
  const auto check = [&](const AnyIndexField& field, const Stage& stage, double index,
                         const BeamLight& beam, double irradiance) {
    RenderScene scene =
        scene_in(field, stage, beam, Camera{at, -Vec3::UnitZ(), Vec3::UnitY(), 1.0, {1, 1}});
    const Rendered result = rendered(scene, {.method = RenderMethod::bidirectional}, 5e4);
    const double film = 4 * std::tan(0.5) * std::tan(0.5) * index * index;
    RenderScene without = scene;
    without.stage.medium = {};
    if (!without.stage.bodies.empty()) without.stage.bodies[0].medium = {};
    const Rendered clear = rendered(without, RenderMethod::bidirectional, 5e4);
    CHECK(clear.value() == doctest::Approx(irradiance / film).epsilon(1e-7));
    const double unscattered = irradiance * std::exp(-0.3 * 2) / film;
    CHECK(result.value() > unscattered);
    CHECK(result.value() < 1.5 * unscattered);
  };
  const BeamLight even{Vec3(0, 0, -1.5), Vec3::UnitZ(), 1, 2 * pi};
  const BeamLight gaussian{Vec3(0, 0, -1.5), Vec3::UnitZ(), 0.5, 2 * pi, Spread::gaussian};
  const double there = 4 / 0.25 * std::exp(-2 * (0.3 * 0.3 + 0.2 * 0.2) / 0.25);
  const Stage ball{stage_box, fog, {Body{Sphere{Vec3(0, 0, -0.5), 0.6}, fog}}, 0.2};
  check(Homogeneous{}, {stage_box, fog}, 1, even, 2);
  check(Homogeneous{0.2}, ball, 1.2, even, 2);
  check(Homogeneous{}, {stage_box, fog}, 1, gaussian, there);
  check(Homogeneous{0.2}, ball, 1.2, gaussian, there);
}

}  // namespace flatspeckle::grin::tests::test_beam_connections
