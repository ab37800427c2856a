#include "grin/render/methods/unscattered_beams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "grin/render/methods/beam_edges.h"
#include "grin/render/transport/beam_join.h"
#include "grin/render/transport/light_tally.h"
#include "grin/render/transport/path_score.h"

namespace flatspeckle::grin {

namespace {

/// A way costs as much as some tens of rays; the search for one where pinholes see none, more.
double share_of_ways(bool is_any_seen) {
  return is_any_seen ? 1.0 / 32 : 1.0 / 512;
}

constexpr double golden = 0.61803398874989484820;
double fraction(double x) {
  return x - std::floor(x);
}

/// Whether rays miss what this sensor sees of a beam, or hit it rarely: light that is refracted or
/// reflected, and straight light to places that few of the rays go to.
bool needs_ways(const Space& space, const SensorEnd& sensor, const StageLights::Beam& beam) {
  constexpr double much = 4;
  constexpr int some = 16;
  if (!sensor.can_be_hit() || space.joins_through()) return true;
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

/// How many bodies a way comes to from outside, one after the other, if none lies in another.
int visits(const Passages& passages) {
  int count = 0;
  bool is_outside = true;
  for (int i = 0; i < passages.count; ++i) {
    count += is_outside;
    if (!passages.reflects(i)) is_outside = !is_outside;
  }
  return count;
}

/// The probability that a search finds a way, as weights take it. Ways by one body are among the
/// seeds, and so are those by two that do not spread light much. Of others, which through rows of
/// balls are more than any search can list, a random trial finds one if it starts in the right
/// direction, within a solid angle that falls with the spread of the light, and takes the right
/// passages.
double found_probability(const BeamWay& way) {
  const int further = std::max(visits(way.passages) - 1, 0);
  if (further == 0 || way.thinning < 1e4 * std::pow(1e-3, further)) return 1;
  return 0.03 * std::pow(0.04, further) / std::max(way.thinning, 1.0);
}

/// Where searches for ways from a sensor to a beam begin, of each sensor and beam, if there are to
/// be any; and whether any light may come that way, as far as a search tells.
struct BeamSeeds {
  std::vector<std::optional<std::vector<BeamSeed>>> of_pair;
  bool is_any_seen = false;
};

bool is_among(std::span<const BeamWay> ways, const BeamWay& one) {
  constexpr double same = 1e-4;  // rad
  return std::any_of(ways.begin(), ways.end(), [&](const BeamWay& way) {
    return way.passages == one.passages &&
           (way.start_direction - one.start_direction).norm() < same;
  });
}

/// Of the ways that random trials find from a few places of the sensor, those that bring most
/// light, each once. Decided by the scene alone.
std::vector<BeamSeed> seeds_of(const Space& space, const SensorEnd& sensor,
                               const StageLights::Beam& beam, int trials, bool& is_any_seen) {
  constexpr std::size_t most = 24;
  const int places = sensor.can_be_hit() ? 4 : 1;
  constexpr auto no_batch = std::numeric_limits<std::uint64_t>::max() - 1;
  RandomStream random(0, static_cast<std::uint64_t>(Stream::render), no_batch);
  ConnectionStatistics statistics;
  const ParallelLight light = beam.light();
  std::vector<BeamSeed> seeds;
  std::vector<std::pair<double, BeamSeed>> found;  // light
  for (int place = 0; place < places; ++place) {
    const EndPosition z = sensor.sample_position(space, random);
    std::vector<BeamWay> known = space.ways_to_beam(z.point, light, seeds, random, statistics);
    is_any_seen |= std::any_of(known.begin(), known.end(),
                               [&](const BeamWay& way) { return beam.disk.contains(way.place); });
    std::erase_if(known, [](const BeamWay& way) { return way.multiplicity != 1; });  // by chance
    for (int i = 0; i < trials / places; ++i) {
      const auto way = space.some_way_to_beam(z.point, light, random, statistics);
      if (!way || is_among(known, *way)) continue;
      known.push_back(*way);
      const double strength = sensor.towards(z, way->start_direction).strength;
      if (!beam.disk.contains(way->place) || !(strength > 0)) continue;
      seeds.push_back({way->start_direction, way->passages, way->first_met});
      found.emplace_back(strength * way->transmittance / way->thinning, seeds.back());
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
          needs_ways(space, sensor, transport.lights.beam_at(beam))
              ? std::optional(seeds_of(space, sensor, transport.lights.beam_at(beam), trials,
                                       seeds.is_any_seen))
              : std::nullopt);
  return seeds;
}

/// What all batches have.
struct BeamsSetup {
  BeamSeeds seeds;
  double ways_per_ray;
  bool books;  ///< where the power of rays goes
  std::shared_ptr<const MovingField> moving;
};

/// Light of beams that meets no collision: rays from the beams that hit sensors, and ways from
/// places of the sensors back to the beams, ways_per_ray of them. What both can find is shared by
/// multiple importance sampling; curved rays that no surface refracts or reflects are the rays'
/// alone where the sensor can be hit.
class UnscatteredBeams {
 public:
  UnscatteredBeams(const Transport& transport, const BeamsSetup& setup, const Space& space,
                   double worth, RandomStream& random, Film& film, TransportCounts& counts)
      : transport_(transport),
        setup_(setup),
        space_(space),
        worth_(worth),
        random_(random),
        film_(film),
        counts_(counts) {
    if (setup.moving) moving_.emplace(*setup.moving, film, counts, false);
  }

  void add_ray(const EndPosition& start, double stratum) {
    add_ray(start, space_.fly(start.point, start.inward, random_), stratum);
  }
  /// That has gone so.
  void add_ray(const EndPosition& start, const Flight& flight, double stratum) {
    counts_.add_flight(flight.end == Flight::End::lost);
    if (setup_.books) book(start, flight);
    if (flight.end == Flight::End::lost) return;
    if (moving_) move(start, flight);
    const StageLights::Beam beam = transport_.lights.beam(stratum);
    for (std::size_t i = 0; i < transport_.sensors.size(); ++i)
      transport_.sensors[i].hit(space_, flight.point.x, flight.direction, [&](const EndHit& hit) {
        const double value = worth_ * transport_.lights.beam_power() * flight.weight * hit.value;
        const double weight = seeds(i, beam) ? weight_of_ray(start, flight, hit, beam) : 1;
        film_.add_hit(hit.direction.pixel, value);
        add(hit.direction.pixel, value * weight, flight.optical_path, flight.arc_length);
      });
  }

  /// After all rays.
  void finish() {
    if (moving_) moving_->finish();
  }

  /// From each sensor that needs them to the beam that the stratum says; they stand for so many
  /// rays.
  void add_ways(double stratum) {
    const StageLights::Beam beam = transport_.lights.beam(stratum);
    for (std::size_t i = 0; i < transport_.sensors.size(); ++i)
      if (const auto& known = seeds(i, beam)) add_ways(transport_.sensors[i], beam, *known);
  }

 private:
  const std::optional<std::vector<BeamSeed>>& seeds(std::size_t sensor,
                                                    const StageLights::Beam& beam) const {
    return setup_.seeds.of_pair[sensor * transport_.lights.beams() + beam.number];
  }
  void move(const EndPosition& start, const Flight& flight) {
    moving_->land(moving_->begin(start.point.x, start.inward), flight.point.x, flight.direction,
                  flight.arc_length, worth_ * transport_.lights.beam_power() * flight.weight);
  }
  void book(const EndPosition& start, const Flight& flight) {
    PathVertex from;
    from.point = start.point;
    from.end = &start;
    from.weight = worth_ * transport_.lights.beam_power();
    LightTally tally(film_.energy);
    tally.emitted(from);
    flight.end == Flight::End::lost ? tally.lost(from, flight) : tally.left(from, flight);
    tally.end_path();
  }
  void add_ways(const SensorEnd& sensor, const StageLights::Beam& beam,
                std::span<const BeamSeed> seeds) {
    const EndPosition z = sensor.sample_position(space_, random_);
    const auto ways =
        space_.ways_to_beam(z.point, beam.light(), seeds, random_, counts_.connections);
    ++counts_.joins;
    for (const BeamWay& way : ways)
      if (beam.disk.contains(way.place)) add_way(sensor, z, beam, way);
  }
  void add_way(const SensorEnd& sensor, const EndPosition& z, const StageLights::Beam& beam,
               const BeamWay& way) {
    const EndDirection to = sensor.towards(z, way.start_direction);
    const double value = beam.irradiance(way.place) * to.strength * way.transmittance /
                         (z.position_density * z.index * z.index * way.thinning);
    double weight = 1;
    if (sensor.can_be_hit()) {
      if (way.passages.count == 0 && space_.has_curves()) return;
      weight = 1 / (1 + 1 / heuristic(ways_over_rays(z, way, beam)));
    }
    add(to.pixel, worth_ * value * weight * way.multiplicity / setup_.ways_per_ray,
        way.optical_path, way.arc_length);
  }

  double weight_of_ray(const EndPosition& start, const Flight& flight, const EndHit& hit,
                       const StageLights::Beam& beam) const {
    if (!flight.is_joinable) return 1;
    if (flight.passages.count == 0) {
      if (space_.has_curves()) return 1;
      return 1 / (1 + heuristic(
                          ways_over_rays(hit.position, -flight.direction, start.point.x, 1, beam)));
    }
    const auto way = space_.beam_way(hit.position.point, beam.light(), -flight.direction,
                                     flight.passages.reversed(), random_);
    return way ? 1 / (1 + heuristic(ways_over_rays(hit.position, *way, beam))) : 1;
  }

  /// The ratio of the densities with which both find a way, per area of the beam. thinning: of the
  /// light on it, times the probability that a search finds it.
  double ways_over_rays(const EndPosition& z, const Vec3& direction, const Vec3& place,
                        double thinning, const StageLights::Beam& beam) const {
    const double by_ways = z.position_density * thinning / z.inward.dot(direction);
    return setup_.ways_per_ray * by_ways / beam.disk.density(place);
  }
  double ways_over_rays(const EndPosition& z, const BeamWay& way,
                        const StageLights::Beam& beam) const {
    return ways_over_rays(z, way.start_direction, way.place, found_probability(way) * way.thinning,
                          beam);
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
  double worth_;
  RandomStream& random_;
  Film& film_;
  TransportCounts& counts_;
  std::optional<MovingPaths> moving_;
};

/// Where the rays of a batch begin, evenly.
class EvenRays {
 public:
  EvenRays(const StageLights& lights, int rays, RandomStream& random)
      : lights_(lights), rays_(rays), first_(random.uniform()), turn_(random.uniform()) {}

  double stratum(int ray) const { return (ray + first_) / rays_; }
  EndPosition start(int ray) const {
    return lights_.beam_position(stratum(ray), fraction(turn_ + ray * golden));
  }

 private:
  const StageLights& lights_;
  int rays_;
  double first_, turn_;
};

/// Rays side by side.
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

/// Whether light can hit a sensor, so that rays of beams are followed.
bool has_area(const Transport& transport) {
  return std::any_of(transport.sensors.begin(), transport.sensors.end(),
                     [](const SensorEnd& sensor) { return sensor.can_be_hit(); });
}

/// Of lines, which cost as much as some hundreds of rays.
void add_edges(const MovingField& field, const StageLights& lights, int rays, double worth,
               RandomStream& random, Film& film, TransportCounts& counts) {
  const int lines = (rays + 255) / 256;
  for (int i = 0; i < lines; ++i) {
    const double stratum = random.uniform(), v = random.uniform();
    BeamEdges(field, lights, stratum, v)
        .add(worth * rays / lines * lights.beam_power(), film, counts);
  }
}

/// in_lanes: all rays may go side by side.
BeamsKernel kernel(std::shared_ptr<const Transport> transport, const BeamsSetup& setup,
                   std::shared_ptr<const Space> space, bool random_phase, bool in_lanes) {
  return [=](int rays, double worth, RandomStream& random, Film& film, TransportCounts& counts) {
    const EvenRays from(transport->lights, rays, random);
    const double beam_of_way = random.uniform(), first_way = random.uniform();
    const auto ways_before = [=](int ray) {
      return std::floor(ray * setup.ways_per_ray + first_way);
    };
    const bool follows_rays = has_area(*transport);
    if (follows_rays && in_lanes) {
      UnscatteredBeams light(*transport, setup, *space, worth, random, film, counts);
      add_rays(*space, rays, from, random, light);
    }
    const auto add = [&](const Space& met, int ray) {
      UnscatteredBeams light(*transport, setup, met, worth, random, film, counts);
      if (follows_rays && !in_lanes) {
        light.add_ray(from.start(ray), from.stratum(ray));
        light.finish();
      }
      if (const double way = ways_before(ray); ways_before(ray + 1) > way)
        light.add_ways(fraction(beam_of_way + way * golden));
    };
    for (int ray = 0; ray < rays; ++ray) {
      if (random_phase)
        add(*space->frozen(2 * std::numbers::pi * random.uniform()), ray);
      else
        add(*space, ray);
    }
    if (setup.moving)
      add_edges(*setup.moving, transport->lights, rays, worth, random, film, counts);
  };
}

}  // namespace

bool are_followed(const Transport& transport) {
  return transport.lights.beam_power() > 0 && has_area(transport);
}

BeamsKernel beams_kernel(const BeamsRequest& request, std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const Space> space) {
  const BeamSeeds seeds = all_seeds(*transport, *space, space->has_curves() ? 512 : 32768);
  const BeamsSetup setup{seeds, share_of_ways(seeds.is_any_seen), request.books, request.moving};
  return kernel(transport, setup, space, request.random_phase,
                !request.random_phase && space->has_lanes());
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
