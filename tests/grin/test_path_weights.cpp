#include <optional>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "bench/scenes/random_fields.h"
#include "core/numbers/random.h"
#include "grin/render/flights/space.h"
#include "grin/render/transport/beam_connection.h"

namespace flatspeckle::grin::tests::test_path_weights {

namespace {

/// An edge of a path, from the light towards the sensor and back.
struct Edge {
  Flight forth, back;
};

/// Vertices of a path, their refractive indices, and the edges between them.
struct WholePath {
  std::vector<PathPoint> points;
  std::vector<double> index;
  std::vector<Edge> edges;
  EndPosition light, sensor;

  /// Returns the sensor's position as chosen from the vertex before it.
  EndPosition chosen_sensor(const Transport& transport) const {
    EndPosition chosen = sensor;
    chosen.choice = transport.sensors[0].choice(sensor, points[points.size() - 2].x);
    return chosen;
  }
};

Flight as_flight(const TestConnection& connection, const PathPoint& to) {
  Flight flight;
  flight.end = Flight::End::collision;
  flight.point = to;
  flight.start_direction = connection.start_direction;
  flight.direction = connection.end_direction;
  flight.spreading = connection.spreading;
  flight.optical_path = connection.optical_path;
  flight.optical_depth = connection.optical_depth;
  flight.crossings = connection.crossings;
  flight.fresnel = connection.fresnel;
  flight.concave_crossings = connection.concave_crossings;
  return flight;
}

/// Returns the reversed flight by the formula of C25, for flights that no connection solves for.
Flight reversed(const Flight& flight, const PathPoint& from, double n_from, double n_to) {
  Flight back = flight;
  back.point = from;
  back.start_direction = -flight.direction;
  back.direction = -flight.start_direction;
  back.spreading = flight.spreading * n_to * n_to / (n_from * n_from);
  return back;
}

double scattering_density(const Transport& transport, const WholePath& path, std::size_t i,
                          bool from_light) {
  const Vec3 in = from_light ? path.edges[i - 1].forth.direction : path.edges[i].back.direction;
  const Vec3 out =
      from_light ? path.edges[i].forth.start_direction : path.edges[i - 1].back.start_direction;
  return transport.medium(path.points[i].part).phase.density(in.dot(out));
}

PathVertex arrived(const Transport& transport, const PathVertex& here, const Flight& flight,
                   double direction_density, double choice, double index) {
  PathVertex next = moved(here, flight, index);
  weigh(next, transport.strategies, here, flight, direction_density, choice);
  return next;
}

PathVertex light_subpath(const Transport& transport, const Space& space, const WholePath& path,
                         int count) {
  PathVertex vertex = end_vertex(transport.strategies, path.light);
  for (int i = 0; i + 1 < count; ++i) {
    const Edge& edge = path.edges[i];
    double density = 1;
    if (i > 0)
      density = scattering_density(transport, path, i, true);
    else if (!path.light.is_beam)
      density = transport.lights.towards(path.light, edge.forth.start_direction).density;
    const PathVertex before = vertex;
    vertex = arrived(transport, before, edge.forth, density, 1, path.index[i + 1]);
    if (i > 0 || !path.light.is_beam || !transport.strategies.connects_beams) continue;
    RandomStream random(6, 91, 0);
    TransportCounts counts;
    weigh_in_beam(transport, space, before, edge.forth, random, counts, vertex);
  }
  return vertex;
}

PathVertex sensor_subpath(const Transport& transport, const WholePath& path, int count) {
  PathVertex vertex = end_vertex(transport.strategies, path.sensor);
  const int last = static_cast<int>(path.points.size()) - 1;
  for (int i = last; i > last + 1 - count; --i) {
    const Edge& edge = path.edges[i - 1];
    const double density =
        i == last ? transport.sensors[0].towards(path.sensor, edge.back.start_direction).density
                  : scattering_density(transport, path, i, false);
    const double choice = i == last ? path.chosen_sensor(transport).choice : 1;
    vertex = arrived(transport, vertex, edge.back, density, choice, path.index[i - 1]);
  }
  return vertex;
}

/// Returns the weight of the strategy that creates all vertices from one side and hits `end`.
double weight_of_hit(const Strategies& allowed, PathVertex last, const EndPosition& end,
                     double density, int more) {
  last.density *= std::abs(end.inward.dot(last.arrived));
  return 1 / (1 + competing_with_hit(allowed, last, end.position_density, density, more));
}

/// Returns the weight of the connection of the first collision to the beam; nullopt if light
/// reached it along another path.
std::optional<double> weight_in_beam(const Transport& transport, const Space& space,
                                     const WholePath& path) {
  if (!transport.strategies.connects_beams || path.points.size() < 3) return {};
  RandomStream random(7, 91, 0);
  ConnectionStatistics statistics;
  const StageLights::Beam beam = transport.lights.beam_of(path.light);
  const auto beam_connection =
      space.simplest_connection_to_beam(path.points[1], beam.light(), random, statistics);
  const Flight& first = path.edges[0].forth;
  if (!beam_connection || !(beam_connection->crossings == first.crossings) ||
      (beam_connection->place - path.points[0].x).norm() > 1e-4)
    return {};
  const PathVertex z = sensor_subpath(transport, path, static_cast<int>(path.points.size()) - 1);
  return connected_to_beam(
             transport, path.light, *beam_connection, z,
             leaving(transport, transport.sensors[0], z, beam_connection->start_direction))
      .weight;
}

/// Returns the weight of the strategy with s vertices from the light; nullopt if there is none.
std::optional<double> weight_of(const Transport& transport, const Space& space,
                                const WholePath& path, int s) {
  const int all = static_cast<int>(path.points.size());
  const Strategies& allowed = transport.strategies;
  if (s == 0) {
    if (path.light.is_point || path.light.is_beam) return {};
    const Vec3& out = path.edges[0].forth.start_direction;
    return weight_of_hit(allowed, sensor_subpath(transport, path, all), path.light,
                         transport.lights.towards(path.light, out).density, allowed.most_light());
  }
  if (s == all) {
    if (path.sensor.is_point) return {};
    const Vec3& out = path.edges.back().back.start_direction;
    PathVertex last = light_subpath(transport, space, path, all);
    last.first_of_other *= heuristic(path.chosen_sensor(transport).choice);
    return weight_of_hit(allowed, last, path.sensor,
                         transport.sensors[0].towards(path.sensor, out).density,
                         allowed.most_sensor());
  }
  if (s == 1 && path.light.is_beam) return weight_in_beam(transport, space, path);
  const Flight& edge = path.edges[s - 1].forth;
  if (!edge.is_connectable) return {};
  const PathVertex y = light_subpath(transport, space, path, s);
  const EndPosition chosen = path.chosen_sensor(transport);
  const PathVertex z = s == all - 1 ? end_vertex(transport.strategies, chosen)
                                    : sensor_subpath(transport, path, all - s);
  const TestConnection curve{.start_direction = edge.start_direction,
                             .end_direction = edge.direction,
                             .spreading = edge.spreading,
                             .optical_path = edge.optical_path,
                             .optical_depth = edge.optical_depth,
                             .crossings = edge.crossings,
                             .fresnel = edge.fresnel,
                             .concave_crossings = edge.concave_crossings};
  return connected_path(allowed, y, leaving(transport, transport.lights, y, curve.start_direction),
                        z, leaving(transport, transport.sensors[0], z, -curve.end_direction), curve)
      .weight;
}

/// Returns the sum of the weights of all strategies that can create a path. With a short subpath
/// these are the strategy with the fewest vertices on its side and, if that is a hit, the next one.
double sum_of_weights(const Transport& transport, const Space& space, const WholePath& path,
                      int& strategies) {
  const int all = static_cast<int>(path.points.size());
  const bool is_short = transport.strategies.short_light || transport.strategies.short_sensor;
  double sum = 0;
  strategies = 0;
  for (int count = 0; count <= all; ++count) {
    const int s = transport.strategies.short_sensor ? all - count : count;
    const auto weight = weight_of(transport, space, path, s);
    if (!weight) continue;
    CHECK(*weight > 0);
    sum += *weight;
    ++strategies;
    if (is_short && count >= 1) break;
    // a surface that is hit is also connected to, unless a body is in between
    if (is_short && !path.edges[s == 0 ? 0 : all - 2].forth.is_connectable) break;
  }
  return sum;
}

constexpr double radius = 1.5;

Stage foggy_ball() {
  return {Sphere{Vec3::Zero(), radius}, {1.2, 0.1, {HgPhase{0.4}}}};
}

Transport transport_of(const Space& space, const Stage& stage, const Light& light,
                       const Sensor& sensor, const Strategies& strategies = {}) {
  return {stage, StageLights({light}, stage, [&](const PathPoint& p) { return space.index(p); }),
          sensor_endpoints({sensor}, stage), strategies};
}

const Strategies path_tracing{.short_light = true};
const Strategies light_tracing{.short_sensor = true};
const Strategies soon_left{.connected_fraction = 0.3, .kept = 0.4};

/// Returns a path through random points, each edge solved for in both directions; nullopt if one
/// has no curve or the two differ.
std::optional<WholePath> random_path(const Transport& transport, const Space& space,
                                     int scatterings, RandomStream& random) {
  WholePath path;
  path.light = transport.lights.sample_position(space, random);
  path.sensor = transport.sensors[0].sample_position(space, random);
  path.points.push_back(path.light.point);
  for (int i = 0; i < scatterings; ++i) path.points.push_back({bench::random_point(random, 1.0)});
  path.points.push_back(path.sensor.point);
  for (const PathPoint& p : path.points) path.index.push_back(space.index(p));
  ConnectionStatistics statistics;
  for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
    const PathPoint &p = path.points[i], &q = path.points[i + 1];
    const auto forth = space.connect(p, q, random, statistics);
    const auto back = space.connect(q, p, random, statistics);
    if (!forth || !back || (forth->start_direction + back->end_direction).norm() > 1e-6)
      return std::nullopt;
    path.edges.push_back({as_flight(*forth, q), as_flight(*back, p)});
  }
  return path;
}

const Light lights[] = {PointLight{Vec3(0.3, -0.2, 0.6)}, FaceLight{Vec3::Zero(), INFINITY}};
const Sensor sensors[] = {Camera{Vec3(0, 0.1, -0.6), Vec3::UnitZ(), Vec3::UnitY(), 3.0, {3, 2}},
                          AreaDetector{Vec3(0, 0, radius), Vec3::UnitY(), 1, 1, {2, 2}, 1.57},
                          AreaDetector{Vec3(0, 0, radius), Vec3::UnitY(), 2, 2, {2, 2}, 0.5},
                          DirectionalDetector{Vec3::UnitZ(), Vec3::UnitY(), 1.5, {2, 2}}};

}  // namespace

TEST_CASE("MIS weights: sum to 1 over all strategies on paths of curved rays") {
  const Stage stage = foggy_ball();
  const auto space = make_space(Fisheye({.centre_excess = 0.7, .radius = 2.5}), stage, {0.02, 20});
  RandomStream random(3, 91, 0);
  int paths = 0;
  for (const Light& light : lights)
    for (const Sensor& sensor : sensors)
      for (const Strategies& mask : {Strategies{}, soon_left, path_tracing, light_tracing}) {
        const Transport transport = transport_of(*space, stage, light, sensor, mask);
        for (int scatterings = 0; scatterings < 6; ++scatterings)
          for (int trial = 0; trial < 20; ++trial) {
            const auto path = random_path(transport, *space, scatterings, random);
            if (!path) continue;
            // a path that the sensor does not detect has no weights
            if (!(transport.sensors[0]
                      .towards(path->sensor, path->edges.back().back.start_direction)
                      .strength > 0))
              continue;
            CAPTURE(scatterings);
            int strategies = 0;
            const double sum = sum_of_weights(transport, *space, *path, strategies);
            if (strategies == 0) continue;
            CHECK(sum == doctest::Approx(1).epsilon(1e-6));
            if (mask.short_light) CHECK(strategies <= 2);
            ++paths;
          }
      }
  CHECK(paths > 150);
}

namespace {

/// Whether the sensor detects light in this direction; other paths have no weights.
bool sees(const Transport& transport, const EndPosition& sensor, const Vec3& direction) {
  return transport.sensors[0].towards(sensor, direction).strength > 0;
}

/// Returns a random walk from the light, then connected to the sensor's point; nullopt if there is
/// no connection or the sensor does not detect it.
std::optional<WholePath> walked_path(const Transport& transport, const Space& space,
                                     int scatterings, RandomStream& random) {
  WholePath path;
  path.light = transport.lights.sample_position(space, random);
  path.sensor = transport.sensors[0].sample_position(space, random);
  path.points.push_back(path.light.point);
  path.index.push_back(path.light.index);
  Vec3 direction = transport.lights.sample_direction(path.light, random).direction;
  const auto add = [&](const Flight& flight) {
    const double from = path.index.back(), to = space.index(flight.point);
    path.edges.push_back({flight, reversed(flight, path.points.back(), from, to)});
    path.points.push_back(flight.point);
    path.index.push_back(to);
  };
  for (int i = 0; i < scatterings; ++i) {
    const Flight flight = space.fly(path.points.back(), direction, random);
    if (flight.end != Flight::End::collision) return std::nullopt;
    add(flight);
    direction = transport.medium(flight.point.part).phase.sample(flight.direction, random);
  }
  ConnectionStatistics statistics;
  if (!space.can_connect(path.points.back(), path.sensor.point)) return std::nullopt;
  const auto last = space.connect(path.points.back(), path.sensor.point, random, statistics);
  if (!last || !sees(transport, path.sensor, -last->end_direction)) return std::nullopt;
  add(as_flight(*last, path.sensor.point));
  return path;
}

/// Returns the number of edges that cross a body's surface and are connectable.
int connected_through(const WholePath& path) {
  int count = 0;
  for (std::size_t i = 0; i < path.edges.size(); ++i)
    count += path.points[i].part != path.points[i + 1].part && path.edges[i].forth.is_connectable;
  return count;
}

}  // namespace

TEST_CASE("MIS weights: sum to 1 on paths through a body without refraction") {
  Stage stage = foggy_ball();
  stage.bodies.push_back({Sphere{Vec3(0.1, 0, 0), 0.8}, {2.5, 0, {}}});
  const auto space = make_space(Homogeneous{}, stage, {0.02, 20});
  RandomStream random(5, 91, 0);
  int paths = 0, through = 0;
  const Light point = PointLight{Vec3(0.3, -0.2, 1.1)};
  const Sensor outside = Camera{Vec3(0, 0.1, -1), Vec3::UnitZ(), Vec3::UnitY(), 2.5, {3, 2}};
  for (const Light& light : {point, lights[1]})
    for (const Sensor& sensor : {outside, sensors[1]})
      for (const Strategies& mask : {Strategies{}, soon_left, path_tracing, light_tracing}) {
        const Transport transport = transport_of(*space, stage, light, sensor, mask);
        for (int trial = 0; trial < 300; ++trial) {
          const auto path = walked_path(transport, *space, trial % 7, random);
          if (!path) continue;
          int strategies = 0;
          const double sum = sum_of_weights(transport, *space, *path, strategies);
          REQUIRE(strategies > 0);
          CHECK(sum == doctest::Approx(1).epsilon(1e-6));
          ++paths;
          through += connected_through(*path);
        }
      }
  CHECK(paths > 300);
  CHECK(through > 200);
}

TEST_CASE("MIS weights: sum to 1 on paths through a body, also from beams and fibres") {
  Stage stage = foggy_ball();
  stage.bodies.push_back({Sphere{Vec3(0.1, 0, 0), 0.8}, {2.5, 0, {}}});
  const auto space = make_space(Fisheye({.centre_excess = 0.7, .radius = 1.5}), stage, {0.02, 20});
  const Light beam = BeamLight{Vec3(0, 0, -1.4), Vec3::UnitZ(), 0.07, 1, Spread::gaussian};
  const Light fibre = FibreLight{Vec3(0, 0, -1.4), Vec3::UnitZ(), 0.1, 0.8};
  RandomStream random(4, 91, 0);
  int paths = 0, crossing = 0;
  for (const Light& light : {lights[1], beam, fibre})
    for (const Sensor& sensor : {sensors[1], sensors[2]})
      for (const Strategies& mask : {Strategies{}, soon_left, path_tracing, light_tracing}) {
        const Transport transport = transport_of(*space, stage, light, sensor, mask);
        for (int trial = 0; trial < 1000; ++trial) {
          const auto path = walked_path(transport, *space, 1 + trial % 7, random);
          if (!path) continue;
          int strategies = 0;
          const double sum = sum_of_weights(transport, *space, *path, strategies);
          if (strategies == 0) continue;
          CHECK(sum == doctest::Approx(1).epsilon(1e-6));
          ++paths;
          for (const Edge& edge : path->edges) crossing += edge.forth.crosses_body;
        }
      }
  CHECK(paths > 300);
  CHECK(crossing > 200);
}

TEST_CASE("MIS weights: sum to 1 on paths from beams with beam connections") {
  const Light beam = BeamLight{Vec3(0.1, 0, -1.2), Vec3::UnitZ(), 0.25, 1, Spread::gaussian};
  Stage with_ball = foggy_ball(), with_glass = with_ball;
  with_ball.bodies.push_back({Sphere{Vec3(0.1, 0, 0), 0.6}, {2.5, 0, {}}});
  with_glass.bodies.push_back({Sphere{Vec3(0.1, 0, 0), 0.6}, {0.5, 0, {}}, 0.4});
  const struct {
    std::string name;
    Stage stage;
    AnyIndexField field;
  } rows[] = {{"nothing refracts", with_ball, Homogeneous{}},
              {"glass ball", with_glass, Homogeneous{}},
              {"guide", foggy_ball(), ParabolicGuide({.axis_excess = 0.5, .alpha = 0.3})}};
  Strategies with_beams{.connects_beams = true}, soon = soon_left, short_light = path_tracing;
  soon.connects_beams = short_light.connects_beams = true;
  RandomStream random(8, 91, 0);
  for (const auto& row : rows) {
    CAPTURE(row.name);
    const auto& [name, stage, field] = row;
    const auto space = make_space(field, stage, {0.02, 20});
    int paths = 0, in_beam = 0;
    for (const Sensor& sensor : {sensors[0], sensors[1], sensors[2]})
      for (const Strategies& mask : {with_beams, soon, short_light}) {
        const Transport transport = transport_of(*space, stage, beam, sensor, mask);
        for (int trial = 0; trial < 300; ++trial) {
          const auto path = walked_path(transport, *space, 1 + trial % 5, random);
          if (!path) continue;
          int strategies = 0;
          const double sum = sum_of_weights(transport, *space, *path, strategies);
          if (strategies == 0) continue;
          CAPTURE(path->edges[0].forth.crossings.count);
          CHECK(sum == doctest::Approx(1).epsilon(1e-8));
          ++paths;
          in_beam += weight_in_beam(transport, *space, *path).has_value();
        }
      }
    CHECK(paths > 150);
    CHECK(in_beam > 100);
  }
}

}  // namespace flatspeckle::grin::tests::test_path_weights
