#include "grin/estimators/analog_light.h"

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>

#include "grin/paths/light_family.h"
#include "grin/paths/light_tally.h"
#include "grin/paths/path_score.h"
#include "grin/rays/ray_lanes.h"

namespace flatspeckle::grin {

namespace {

/// What all paths of a batch add to.
struct AnalogBatch {
  const Transport& transport;
  const CurvedSpace& space;
  Film& film;
  TransportCounts& counts;
};

template <bool timed>
class AnalogPath {
 public:
  AnalogPath(const AnalogBatch& batch, const RandomStream& random)
      : batch_(batch),
        random_(random),
        end_(batch.transport.lights.sample_position(batch.space, random_)),
        here_(end_vertex({}, end_)),
        tally_(batch.film.energy) {
    const EndDirection first = batch.transport.lights.sample_direction(end_, random_);
    here_.weight *= first.strength / first.density;
    direction_ = first.direction;
    tally_.emitted(here_);
    absorption_.begin(here_, direction_);
  }
  AnalogPath(const AnalogPath&) = delete;  // a vertex knows its end
  ~AnalogPath() { tally_.end_path(); }

  CurvedSpace::FlightStart next_flight() { return {here_.point, direction_, &random_}; }

  /// Whether it goes on.
  bool flew(const Flight& flight) {
    TransportCounts& counts = batch_.counts;
    counts.add_flight(flight.end == Flight::End::lost);
    if (flight.end == Flight::End::lost) {
      tally_.lost(here_, flight);
      return false;
    }
    score_.flew(flight.arc_length);
    PathVertex next = moved(here_, flight, batch_.space.index(flight.point));
    if (flight.end == Flight::End::boundary) {
      tally_.left(here_, flight);
      if (!end_.is_beam || next.vertices > 2) arrive(next);
      return false;
    }
    if (next.vertices - 2 >= batch_.transport.max_scatterings) {
      tally_.cut(here_, flight);
      return false;
    }
    ++counts.light_collisions;
    const ScatteringMedium& medium = batch_.transport.medium(next.point.part);
    next.weight *= medium.albedo();
    if (!absorption_.collide(here_, flight, medium, next, random_, counts, tally_)) return false;
    here_ = next;
    direction_ = medium.phase.sample(here_.arrived, random_);
    if (batch_.film.has_derivatives()) score_.turned(medium, here_.arrived.dot(direction_));
    return here_.weight > 0;
  }

 private:
  void arrive(const PathVertex& last) {
    for (const SensorEnd& sensor : batch_.transport.sensors)
      sensor.hit(batch_.space, last.point.x, last.arrived, [&](const EndHit& hit) {
        const double value = last.weight * hit.value;
        deposit<timed>(batch_.film, batch_.counts, hit.direction.pixel, value, last.optical_path);
        if (batch_.film.has_derivatives())
          score_.add_to(batch_.film, hit.direction.pixel, value,
                        batch_.transport.medium(last.point.part));
      });
  }

  AnalogBatch batch_;
  RandomStream random_;
  EndPosition end_;
  PathVertex here_;
  Vec3 direction_;
  LonePath absorption_;
  PathScore score_;
  LightTally tally_;
};

/// Of the paths of a batch, each its own.
class PathStreams {
 public:
  PathStreams(int paths, RandomStream& random)
      : key_{random.bits(), random.bits()}, paths_(static_cast<std::uint64_t>(paths)) {}

  bool are_left() const { return next_ < paths_; }
  RandomStream next() { return {key_[0], key_[1], next_++}; }

 private:
  std::uint64_t key_[2], paths_, next_ = 0;
};

template <bool timed>
void walk_in_lanes(const AnalogBatch& batch, PathStreams& streams) {
  std::array<std::optional<AnalogPath<timed>>, lanes> paths;
  const auto next = [&](int lane, const Flight* flown) -> std::optional<CurvedSpace::FlightStart> {
    auto& path = paths[static_cast<std::size_t>(lane)];
    if (path && !path->flew(*flown)) path.reset();
    if (!path) {
      if (!streams.are_left()) return std::nullopt;
      path.emplace(batch, streams.next());
    }
    return path->next_flight();
  };
  batch.space.fly_side_by_side(next);
}

template <bool timed>
void walk(const AnalogBatch& batch, const RandomStream& random) {
  AnalogPath<timed> path(batch, random);
  for (;;) {
    const auto [from, direction, own] = path.next_flight();
    if (!path.flew(batch.space.fly(from, direction, *own))) return;
  }
}

template <bool timed>
PathKernel kernel_of(std::shared_ptr<const Transport> transport,
                     std::shared_ptr<const CurvedSpace> space, bool random_phase) {
  return [=](int paths, RandomStream& random, Film& film, TransportCounts& counts, JoinPromises*) {
    PathStreams streams(paths, random);
    if (!random_phase && space->has_lanes())
      return walk_in_lanes<timed>({*transport, *space, film, counts}, streams);
    while (streams.are_left()) {
      RandomStream own = streams.next();
      if (!random_phase) {
        walk<timed>({*transport, *space, film, counts}, own);
        continue;
      }
      const auto met = space->frozen(2 * std::numbers::pi * own.uniform());
      walk<timed>({*transport, *met, film, counts}, own);
    }
  };
}

}  // namespace

PathKernel analog_kernel(bool timed, std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const CurvedSpace> space, bool random_phase) {
  return timed ? kernel_of<true>(transport, space, random_phase)
               : kernel_of<false>(transport, space, random_phase);
}

}  // namespace flatspeckle::grin
