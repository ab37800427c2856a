#include "grin/render/methods/unscattered_beams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "grin/render/methods/beam_edges.h"
#include "grin/render/transport/beam_connection.h"
#include "grin/render/transport/light_tally.h"
#include "grin/render/transport/path_score.h"
#include "grin/render/transport/scrambled_sobol.h"

namespace flatspeckle::grin {

namespace {

/// Returns the number of connections per ray. A connection costs as much as some tens of rays;
/// connections that have not been found to bring any light are rarely tried.
double fraction_of_connections_found(bool is_any_seen) {
  return is_any_seen ? 1.0 / 32 : 1.0 / 512;
}

constexpr double golden = 0.61803398874989484820;
double fraction(double x) {
  return x - std::floor(x);
}

/// Whether rays rarely or never hit this sensor although light of the beam reaches it. This may be
/// so if the sensor cannot be hit, if bodies refract or reflect the light, or if straight light
/// arrives at positions that few rays hit.
bool needs_connections(const Space& space, const SensorEnd& sensor, const StageLights::Beam& beam) {
  constexpr double much = 4;
  constexpr int some = 16;
  if (!sensor.can_be_hit() || space.connects_through()) return true;
  if (space.has_curves()) return false;
  RandomStream random(0, static_cast<std::uint64_t>(Stream::render), 0);
  for (int i = 0; i < some; ++i) {
    const EndPosition z = sensor.sample_position(space, random);
    const auto place = straight_place(beam.light(), z.point.x);
    if (place && beam.disk.contains(*place) &&
        z.position_density > much * beam.disk.density(*place))
      return true;
  }
  return false;
}

/// Returns the number of times that a path meets a body from outside, if no body lies inside
/// another.
int visits(const InterfaceCrossings& crossings) {
  int count = 0;
  bool is_outside = true;
  for (int i = 0; i < crossings.count; ++i) {
    count += is_outside;
    if (!crossings.reflects(i)) is_outside = !is_outside;
  }
  return count;
}

/// Assumed probability that a search finds a connection, for MIS weights. The search starts
/// from a list of connections through one body, and through two bodies that spread light little.
/// Other connections, such as those through rows of balls, may be too numerous to list. A random
/// trial finds such a connection if it starts within a solid angle that decreases as the light is
/// spread more, and samples the same crossings.
double found_probability(const BeamConnection& connection) {
  const int further = std::max(visits(connection.crossings) - 1, 0);
  if (further == 0 || connection.thinning < 1e4 * std::pow(1e-3, further)) return 1;
  return 0.03 * std::pow(0.04, further) / std::max(connection.thinning, 1.0);
}

/// Seeds of searches for connections, by pair of sensor and beam; nullopt for pairs that need no
/// connections. is_any_seen: whether light may arrive by connections, as far as the search for
/// seeds shows.
struct BeamSeeds {
  std::vector<std::optional<std::vector<BeamSeed>>> of_pair;
  bool is_any_seen = false;
};

bool is_among(std::span<const BeamConnection> connections, const BeamConnection& one) {
  constexpr double same = 1e-4;  // rad
  return std::any_of(connections.begin(), connections.end(), [&](const BeamConnection& connection) {
    return connection.crossings == one.crossings &&
           (connection.start_direction - one.start_direction).norm() < same;
  });
}

/// Returns, as seeds, the distinct connections of highest contribution that random trials find from
/// a few positions on the sensor. The result depends only on the scene.
std::vector<BeamSeed> seeds_of(const Space& space, const SensorEnd& sensor,
                               const StageLights::Beam& beam, int trials, bool& is_any_seen) {
  constexpr std::size_t most = 24;
  const int places = sensor.can_be_hit() ? 4 : 1;
  constexpr auto no_batch = std::numeric_limits<std::uint64_t>::max() - 1;
  RandomStream random(0, static_cast<std::uint64_t>(Stream::render), no_batch);
  ConnectionStatistics statistics;
  const ParallelLight light = beam.light();
  std::vector<BeamSeed> seeds;
  std::vector<std::pair<double, BeamSeed>> found;  // with their contributions
  for (int place = 0; place < places; ++place) {
    const EndPosition z = sensor.sample_position(space, random);
    std::vector<BeamConnection> known =
        space.connections_to_beam(z.point, light, seeds, random, statistics);
    is_any_seen |= std::any_of(known.begin(), known.end(), [&](const BeamConnection& connection) {
      return beam.disk.contains(connection.place);
    });
    std::erase_if(known, [](const BeamConnection& connection) {
      return connection.multiplicity != 1;
    });  // found by a random trial
    for (int i = 0; i < trials / places; ++i) {
      const auto connection = space.some_connection_to_beam(z.point, light, random, statistics);
      if (!connection || is_among(known, *connection)) continue;
      known.push_back(*connection);
      const double strength = sensor.towards(z, connection->start_direction).strength;
      if (!beam.disk.contains(connection->place) || !(strength > 0)) continue;
      seeds.push_back({connection->start_direction, connection->crossings, connection->first_met});
      found.emplace_back(strength * connection->transmittance / connection->thinning, seeds.back());
    }
  }
  is_any_seen |= sensor.can_be_hit() || !seeds.empty();
  if (seeds.size() <= most) return seeds;
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first > b.first; });
  for (std::size_t i = 0; i < most; ++i) seeds[i] = found[i].second;
  seeds.resize(most);
  return seeds;
}

BeamSeeds all_seeds(const Transport& transport, const Space& space, int trials) {
  trials /= static_cast<int>(std::min<std::size_t>(transport.lights.beams(), 8));
  BeamSeeds seeds;
  for (const SensorEnd& sensor : transport.sensors)
    for (std::size_t beam = 0; beam < transport.lights.beams(); ++beam)
      seeds.of_pair.push_back(
          needs_connections(space, sensor, transport.lights.beam_at(beam))
              ? std::optional(seeds_of(space, sensor, transport.lights.beam_at(beam), trials,
                                       seeds.is_any_seen))
              : std::nullopt);
  return seeds;
}

/// Data shared by all batches.
struct BeamsSetup {
  BeamSeeds seeds;
  double connections_per_ray;
  bool tallies_power;  ///< whether the power of rays is tallied
  std::shared_ptr<const MovingField> moving;
};

/// Unscattered light of beams: rays from the beams that hit sensors, and connections from positions
/// on the sensors back to the beams, connections_per_ray per ray. MIS combines the two strategies
/// for paths that both can find. If the sensor can be hit, curved paths without refraction or
/// reflection are left to the rays.
class UnscatteredBeams {
 public:
  UnscatteredBeams(const Transport& transport, const BeamsSetup& setup, const Space& space,
                   double paths_per_ray, RandomStream& random, Film& film, TransportCounts& counts)
      : transport_(transport),
        setup_(setup),
        space_(space),
        ray_weight_(paths_per_ray),
        random_(random),
        film_(film),
        counts_(counts) {
    if (setup.moving) moving_.emplace(*setup.moving, film, counts, false);
  }

  void add_ray(const EndPosition& start, double stratum) {
    add_ray(start, space_.fly(start.point, start.inward, random_), stratum);
  }
  /// Adds a ray that has been traced.
  void add_ray(const EndPosition& start, const Flight& flight, double stratum) {
    counts_.add_flight(flight.end == Flight::End::lost);
    if (setup_.tallies_power) tally_power(start, flight);
    if (flight.end == Flight::End::lost) return;
    if (moving_) move(start, flight);
    const StageLights::Beam beam = transport_.lights.beam(stratum);
    for (std::size_t i = 0; i < transport_.sensors.size(); ++i)
      transport_.sensors[i].hit(space_, flight.point.x, flight.direction, [&](const EndHit& hit) {
        const double value =
            ray_weight_ * transport_.lights.beam_power() * flight.weight * hit.value;
        const double weight = seeds(i, beam) ? weight_of_ray(start, flight, hit, beam) : 1;
        film_.add_hit(hit.direction.pixel, value);
        add(hit.direction.pixel, value * weight, flight.optical_path, flight.arc_length);
      });
  }

  /// Completes the derivatives after all rays.
  void finish() {
    if (moving_) moving_->finish();
  }

  /// Adds connections to the beam selected by the stratum, from each sensor that needs connections;
  /// each connection represents 1 / connections_per_ray rays.
  void add_connections(double stratum) {
    const StageLights::Beam beam = transport_.lights.beam(stratum);
    for (std::size_t i = 0; i < transport_.sensors.size(); ++i)
      if (const auto& known = seeds(i, beam)) add_connections(transport_.sensors[i], beam, *known);
  }

 private:
  const std::optional<std::vector<BeamSeed>>& seeds(std::size_t sensor,
                                                    const StageLights::Beam& beam) const {
    return setup_.seeds.of_pair[sensor * transport_.lights.beams() + beam.number];
  }
  void move(const EndPosition& start, const Flight& flight) {
    moving_->land(moving_->begin(start.point.x, start.inward), flight.point.x, flight.direction,
                  flight.arc_length, ray_weight_ * transport_.lights.beam_power() * flight.weight);
  }
  void tally_power(const EndPosition& start, const Flight& flight) {
    PathVertex from;
    from.point = start.point;
    from.end = &start;
    from.weight = ray_weight_ * transport_.lights.beam_power();
    LightTally tally(film_.energy);
    tally.emitted(from);
    flight.end == Flight::End::lost ? tally.lost(from, flight) : tally.left(from, flight);
    tally.end_path();
  }
  void add_connections(const SensorEnd& sensor, const StageLights::Beam& beam,
                       std::span<const BeamSeed> seeds) {
    const EndPosition z = sensor.sample_position(space_, random_);
    const auto connections =
        space_.connections_to_beam(z.point, beam.light(), seeds, random_, counts_.connections);
    ++counts_.connections_made;
    for (const BeamConnection& connection : connections)
      if (beam.disk.contains(connection.place)) add_connection(sensor, z, beam, connection);
  }
  void add_connection(const SensorEnd& sensor, const EndPosition& z, const StageLights::Beam& beam,
                      const BeamConnection& connection) {
    const EndDirection to = sensor.towards(z, connection.start_direction);
    const double value = beam.irradiance(connection.place) * to.strength *
                         connection.transmittance /
                         (z.position_density * z.index * z.index * connection.thinning);
    double weight = 1;
    if (sensor.can_be_hit()) {
      if (connection.crossings.count == 0 && space_.has_curves()) return;
      weight = 1 / (1 + 1 / heuristic(connections_over_rays(z, connection, beam)));
    }
    add(to.pixel,
        ray_weight_ * value * weight * connection.multiplicity / setup_.connections_per_ray,
        connection.optical_path, connection.arc_length);
  }

  double weight_of_ray(const EndPosition& start, const Flight& flight, const EndHit& hit,
                       const StageLights::Beam& beam) const {
    if (!flight.is_connectable) return 1;
    if (flight.crossings.count == 0) {
      if (space_.has_curves()) return 1;
      return 1 / (1 + heuristic(connections_over_rays(hit.position, -flight.direction,
                                                      start.point.x, 1, beam)));
    }
    const auto connection = space_.beam_connection(
        hit.position.point, beam.light(), -flight.direction, flight.crossings.reversed(), random_);
    return connection ? 1 / (1 + heuristic(connections_over_rays(hit.position, *connection, beam)))
                      : 1;
  }

  /// Returns the ratio of the densities with which connections and rays find a path, per area of
  /// the beam. thinning: thinning of the light (BeamConnection), times the probability that a
  /// search finds the path.
  double connections_over_rays(const EndPosition& z, const Vec3& direction, const Vec3& place,
                               double thinning, const StageLights::Beam& beam) const {
    const double by_alternatives = z.position_density * thinning / z.inward.dot(direction);
    return setup_.connections_per_ray * by_alternatives / beam.disk.density(place);
  }
  double connections_over_rays(const EndPosition& z, const BeamConnection& connection,
                               const StageLights::Beam& beam) const {
    return connections_over_rays(z, connection.start_direction, connection.place,
                                 found_probability(connection) * connection.thinning, beam);
  }
  void add(int pixel, double value, double optical_path, double arc_length) {
    deposit(film_, counts_, pixel, value, optical_path);
    if (!film_.has_derivatives()) return;
    PathScore score;
    score.flew(arc_length);
    score.add_to(film_, pixel, value, transport_.medium(around));
  }

  const Transport& transport_;
  const BeamsSetup& setup_;
  const Space& space_;
  double ray_weight_;
  RandomStream& random_;
  Film& film_;
  TransportCounts& counts_;
  std::optional<MovingPaths> moving_;
};

/// Starts of the rays of a batch, spread evenly over the beams.
class EvenRays {
 public:
  EvenRays(const StageLights& lights, int rays, RandomStream& random)
      : lights_(lights),
        rays_(rays),
        first_(random.uniform()),
        turn_(random.uniform()),
        choices_(random.bits(), 0) {}

  double stratum(int ray) const { return (ray + first_) / rays_; }
  EndPosition start(int ray) const {
    return lights_.beam_position(stratum(ray), fraction(turn_ + ray * golden));
  }
  /// Stratifies the random numbers by which a ray is reflected or refracted at its first surfaces.
  void lead(int ray, RandomStream& random) const {
    random.lead(choices_.point(static_cast<std::uint64_t>(ray)));
  }

 private:
  const StageLights& lights_;
  int rays_;
  double first_, turn_;
  ScrambledSobol choices_;
};

/// Traces rays in SIMD lanes.
void add_rays(const Space& space, int rays, const EvenRays& from, RandomStream& random,
              UnscatteredBeams& light) {
  std::array<int, lanes> number{};
  std::array<EndPosition, lanes> starts{};
  int next = 0;
  space.fly_side_by_side([&](int lane, const Flight* flown) -> std::optional<Space::FlightStart> {
    int& own = number[static_cast<std::size_t>(lane)];
    EndPosition& start = starts[static_cast<std::size_t>(lane)];
    if (flown) light.add_ray(start, *flown, from.stratum(own));
    if (next == rays) return std::nullopt;
    own = next++;
    start = from.start(own);
    return Space::FlightStart{start.point, start.inward, &random};
  });
  light.finish();
}

/// Whether light can hit some sensor, so that rays of beams must be traced.
bool has_area(const Transport& transport) {
  return std::any_of(transport.sensors.begin(), transport.sensors.end(),
                     [](const SensorEnd& sensor) { return sensor.can_be_hit(); });
}

/// Adds derivatives due to light that crosses pixel edges (BeamEdges), along lines that each cost
/// as much as some hundreds of rays.
void add_edges(const MovingField& field, const StageLights& lights, int rays, double paths_per_ray,
               RandomStream& random, Film& film, TransportCounts& counts) {
  const int lines = (rays + 255) / 256;
  for (int i = 0; i < lines; ++i) {
    const double stratum = random.uniform(), v = random.uniform();
    BeamEdges(field, lights, stratum, v)
        .add(paths_per_ray * rays / lines * lights.beam_power(), film, counts);
  }
}

/// Makes the kernel of unscattered beams. in_lanes: rays are traced in SIMD lanes.
BeamsKernel kernel(std::shared_ptr<const Transport> transport, const BeamsSetup& setup,
                   std::shared_ptr<const Space> space, bool random_phase, bool in_lanes) {
  return [=](int rays, double paths_per_ray, RandomStream& random, Film& film,
             TransportCounts& counts) {
    const EvenRays from(transport->lights, rays, random);
    const double beam_of_connection = random.uniform(), first_path = random.uniform();
    const auto connections_before = [=](int ray) {
      return std::floor(ray * setup.connections_per_ray + first_path);
    };
    const bool follows_rays = has_area(*transport);
    if (follows_rays && in_lanes) {
      UnscatteredBeams light(*transport, setup, *space, paths_per_ray, random, film, counts);
      add_rays(*space, rays, from, random, light);
    }
    const auto add = [&](const Space& met, int ray) {
      UnscatteredBeams light(*transport, setup, met, paths_per_ray, random, film, counts);
      if (follows_rays && !in_lanes) {
        from.lead(ray, random);
        light.add_ray(from.start(ray), from.stratum(ray));
        light.finish();
      }
      if (const double number = connections_before(ray); connections_before(ray + 1) > number)
        light.add_connections(fraction(beam_of_connection + number * golden));
    };
    for (int ray = 0; ray < rays; ++ray) {
      if (random_phase)
        add(*space->frozen(2 * std::numbers::pi * random.uniform()), ray);
      else
        add(*space, ray);
    }
    if (setup.moving)
      add_edges(*setup.moving, transport->lights, rays, paths_per_ray, random, film, counts);
  };
}

}  // namespace

bool are_followed(const Transport& transport) {
  return transport.lights.beam_power() > 0 && has_area(transport);
}

BeamsKernel beams_kernel(const BeamsRequest& request, std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const Space> space) {
  BeamSeeds seeds;
  if (request.connects)
    seeds = all_seeds(*transport, *space, space->has_curves() ? 512 : 32768);
  else
    seeds.of_pair.resize(transport->sensors.size() * transport->lights.beams());
  const BeamsSetup setup{seeds, fraction_of_connections_found(seeds.is_any_seen),
                         request.tallies_power, request.moving};
  return kernel(transport, setup, space, request.random_phase,
                !request.random_phase && space->has_lanes());
}

double fraction_that_hits(const Transport& transport, const Space& space) {
  constexpr int some = 64;
  RandomStream random(0, static_cast<std::uint64_t>(Stream::render), 0);
  const EvenRays from(transport.lights, some, random);
  std::vector<double> hits(transport.sensors.size());
  for (int ray = 0; ray < some; ++ray) {
    const EndPosition start = from.start(ray);
    const Flight flight = space.fly(start.point, start.inward, random);
    for (std::size_t i = 0; i < hits.size(); ++i)
      transport.sensors[i].hit(space, flight.point.x, flight.direction,
                               [&](const EndHit&) { hits[i] += 1.0 / some; });
  }
  return std::ranges::min(hits);
}

double rays_beside_path(const StageLights& lights, const Space& space) {
  constexpr int some = 16;
  RandomStream random(0, static_cast<std::uint64_t>(Stream::render), 0);
  const EvenRays from(lights, some, random);
  double light_left = 0;
  for (int ray = 0; ray < some; ++ray) {
    const EndPosition start = from.start(ray);
    light_left += space.fly(start.point, start.inward, random).weight / some;
  }
  return std::clamp(10 * light_left, 1.0 / 16, 1.0);
}

}  // namespace flatspeckle::grin
