#include "grin/render/methods/analog_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "grin/media/scattering/even_turns.h"
#include "grin/rays/marching/ray_lanes.h"
#include "grin/render/methods/moving_paths.h"
#include "grin/render/transport/light_family.h"
#include "grin/render/transport/light_tally.h"
#include "grin/render/transport/path_score.h"

namespace flatspeckle::grin {

namespace {

// Found by trials with guides of sound in tissue of three mean free paths. Where it is far from
// what is so, variance is lost.
constexpr double share_lost = 0.7;  // of light that scatters on its way along a guide
constexpr double share_kept = 0.6;  // of the angles that a field keeps
constexpr double spread = 0.5;      // rad, of light that still scatters before the sensor
constexpr double deepest = 3;       // mean free paths that are seen ahead
constexpr double least = 1.0 / 32;  // of what heads elsewhere: none that returns is worth too much

constexpr double parts = 2;  // of a path to begin with: they share its first flight

constexpr int some = 64;  // samples of ends

RandomStream stream_of_trials() {
  return {0, static_cast<std::uint64_t>(Stream::render), 0};
}

/// What all paths of a batch add to.
struct AnalogBatch {
  const Transport& transport;
  const Space& space;
  const SensorAim* aim;
  Film& film;
  TransportCounts& counts;
  const MovingField* moving;
};

/// A path, or a part of one that is split, with random numbers of its own: what becomes of others
/// does not change it, so that paths of like scenes stay alike.
struct Branch {
  RandomStream random;
  PathVertex from = {};
  Vec3 direction = Vec3::Zero();
  double power = 0;  ///< that its path began with
  bool of_beam = false;
  LonePath absorption = {};
  PathScore score = {};
  int flight = 0;  ///< of moving paths
};

/// Of a path that is to begin: its random numbers, and its place in (0, 1) among those of a batch,
/// which their first flights are drawn by, evenly.
struct FreshPath {
  RandomStream random;
  double place;
};

/// The paths of a batch, in lanes that have one branch each at a time; those that wait are taken
/// up by any.
class AnalogWalk {
 public:
  struct Lane {
    EndPosition end;  ///< of its path's first flight
    std::optional<Branch> now;
  };
  /// The next path, if there is one.
  using Fresh = std::function<std::optional<FreshPath>()>;

  AnalogWalk(const AnalogBatch& batch, Fresh fresh)
      : batch_(batch), fresh_(std::move(fresh)), tally_(batch.film.energy) {
    if (batch.moving) moving_.emplace(*batch.moving, batch.film, batch.counts);
  }
  ~AnalogWalk() { tally_.end_path(); }

  /// After all paths.
  void finish() {
    if (moving_) moving_->finish();
  }

  /// flown: what became of the lane's last flight, if it had one.
  std::optional<Space::FlightStart> next(Lane& lane, const Flight* flown) {
    if (lane.now && !goes_on(*lane.now, *flown)) lane.now.reset();
    if (!lane.now) begin(lane);
    if (!lane.now) return std::nullopt;
    return Space::FlightStart{lane.now->from.point, lane.now->direction, &lane.now->random};
  }

 private:
  void begin(Lane& lane) {
    if (!waiting_.empty()) {
      lane.now = waiting_.back();
      waiting_.pop_back();
    } else if (const auto fresh = fresh_()) {
      begin(lane, *fresh);
    }
  }
  void begin(Lane& lane, const FreshPath& fresh) {
    const StageLights& lights = batch_.transport.lights;
    Branch& now = lane.now.emplace(Branch{fresh.random});
    lane.end = lights.sample_position(batch_.space, now.random);
    now.from = end_vertex({}, lane.end);
    const EndDirection first = lights.sample_direction(lane.end, now.random);
    now.from.weight *= first.strength / first.density;
    now.direction = first.direction;
    now.power = now.from.weight;
    now.of_beam = lane.end.is_beam;
    tally_.emitted(now.from);
    now.absorption.begin(now.from, now.direction);
    if (moving_)
      now.flight =
          moving_->begin(now.from.point.x, now.direction, lights.by_index(lane.end, now.direction));
    draw_flight(now, fresh.place);
  }
  /// The first.
  void draw_flight(Branch& now, double place) {
    if (!batch_.aim) return now.random.put_back(place);
    const PulledFlight flight = batch_.aim->first_flight(now.from.point.x, now.direction, place);
    now.random.put_back(flight.u);
    now.from.weight = reweighed(now.from.point, now.from.weight, flight.weight * now.from.weight);
  }
  /// The weight after, of light at a place.
  double reweighed(const PathPoint& at, double before, double after) {
    tally_.reweighed(at.part, batch_.transport.medium(at.part).mu_a > 0, before - after);
    return after;
  }

  bool goes_on(Branch& now, const Flight& flight) {
    TransportCounts& counts = batch_.counts;
    counts.add_flight(flight.end == Flight::End::lost);
    if (flight.end == Flight::End::lost) {
      tally_.lost(now.from, flight);
      return false;
    }
    now.score.flew(flight.arc_length);
    PathVertex next = moved(now.from, flight, batch_.space.index(flight.point));
    if (flight.end == Flight::End::boundary) {
      tally_.left(now.from, flight);
      if (!now.of_beam || next.vertices > 2) arrive(now, next, flight.arc_length);
      return false;
    }
    if (next.vertices - 2 >= batch_.transport.max_scatterings) {
      tally_.cut(now.from, flight);
      return false;
    }
    ++counts.light_collisions;
    const ScatteringMedium& medium = batch_.transport.medium(next.point.part);
    next.weight *= medium.albedo();
    if (!now.absorption.collide(now.from, flight, medium, next, now.random, counts, tally_))
      return false;
    now.from = next;
    if (batch_.aim) return split(medium, now, flight.arc_length);
    turn(medium, flight.arc_length, medium.phase.sample(next.arrived, now.random), now);
    return next.weight > 0;
  }
  void turn(const ScatteringMedium& medium, double flown, const Vec3& direction, Branch& branch) {
    branch.direction = direction;
    if (moving_)
      branch.flight =
          moving_->go_on(branch.flight, branch.from.point.x, branch.from.arrived, flown, direction);
    if (batch_.film.has_derivatives()) branch.score.turned(medium, branch.from.arrived, direction);
  }

  /// Into as many as it is worth, of which those stay that head for the sensors. Whether one does.
  bool split(const ScatteringMedium& medium, Branch& now, double flown) {
    constexpr double most = 16;
    const Branch before = now;
    const PathVertex& from = before.from;
    const double worth =
        from.weight / now.power * batch_.aim->before_turn(from.point.x, from.arrived);
    const double copies = std::clamp(std::round(worth), 1.0, most);
    EvenTurns turns(medium.phase, from.arrived, copies, now.random);
    EvenRoulette roulette(now.random);
    const std::uint64_t key[] = {now.random.bits(), now.random.bits()};
    bool is_left = false;
    for (std::uint64_t i = 0; static_cast<double>(i) < copies; ++i) {
      RandomStream random(key[0], key[1], i);
      const Vec3 direction = turns.next(random);
      const double weight = kept(before, from.weight / copies, direction, roulette);
      if (!(weight > 0)) continue;
      Branch& branch = is_left ? waiting_.emplace_back(before) : now;
      is_left = true;
      branch.random = random;
      branch.from.weight = weight;
      turn(medium, flown, direction, branch);
    }
    return is_left;
  }
  /// The weight where roulette leaves any.
  double kept(const Branch& before, double weight, const Vec3& direction, EvenRoulette& roulette) {
    const PathPoint& at = before.from.point;
    const double chance = weight / before.power * batch_.aim->towards(at.x, direction);
    if (chance >= 1) return weight;
    return reweighed(at, weight, roulette.keeps(chance) ? weight / chance : 0);
  }

  void arrive(const Branch& now, const PathVertex& last, double flown) {
    if (moving_) moving_->land(now.flight, last.point.x, last.arrived, flown, last.weight);
    for (const SensorEnd& sensor : batch_.transport.sensors)
      sensor.hit(batch_.space, last.point.x, last.arrived, [&](const EndHit& hit) {
        const double value = last.weight * hit.value;
        deposit(batch_.film, batch_.counts, hit.direction.pixel, value, last.optical_path);
        batch_.film.add_hit(hit.direction.pixel, value);
        if (batch_.film.has_derivatives())
          now.score.add_to(batch_.film, hit.direction.pixel, value,
                           batch_.transport.medium(last.point.part));
      });
  }

  AnalogBatch batch_;
  Fresh fresh_;
  std::vector<Branch> waiting_;
  LightTally tally_;
  std::optional<MovingPaths> moving_;
};

/// Of the paths of a batch, each its own.
class PathStreams {
 public:
  PathStreams(int paths, RandomStream& random)
      : key_{random.bits(), random.bits()}, first_(random.uniform()), paths_(paths) {}

  std::optional<FreshPath> next() {
    if (next_ == paths_) return std::nullopt;
    const double place = (next_ + first_) / paths_;
    return FreshPath{{key_[0], key_[1], static_cast<std::uint64_t>(next_++)}, place};
  }

 private:
  std::uint64_t key_[2];
  double first_;
  int paths_, next_ = 0;
};

void walk_in_lanes(const AnalogBatch& batch, PathStreams& streams) {
  AnalogWalk walk(batch, [&] { return streams.next(); });
  std::array<AnalogWalk::Lane, lanes> all;
  batch.space.fly_side_by_side([&](int lane, const Flight* flown) {
    return walk.next(all[static_cast<std::size_t>(lane)], flown);
  });
  walk.finish();
}

/// One path.
void walk(const AnalogBatch& batch, const FreshPath& path) {
  std::optional<FreshPath> one = path;
  AnalogWalk walk(batch, [&] { return std::exchange(one, std::nullopt); });
  AnalogWalk::Lane lane;
  std::optional<Flight> flown;
  while (const auto start = walk.next(lane, flown ? &*flown : nullptr))
    flown = batch.space.fly(start->from, start->direction, *start->random);
  walk.finish();
}

}  // namespace

std::optional<SensorAim> SensorAim::of(const Transport& transport, const Space& space,
                                       double bending) {
  constexpr double small = 0.1;  // of the stage
  const ScatteringMedium& medium = transport.stage.medium;
  if (!(medium.mu_s > 0)) return std::nullopt;
  const Box box = bounds(transport.stage.boundary);
  std::vector<Disk> disks;
  for (const SensorEnd& sensor : transport.sensors) {
    const auto disk = disk_of(sensor, space, small * (box.high - box.low).maxCoeff());
    if (!disk) return std::nullopt;
    disks.push_back(*disk);
  }
  SensorAim aim(std::move(disks), medium, bending);
  aim.usual_ = aim.usual(transport, space);
  return aim;
}

/// About as large as the sensor's places are spread; nothing where that is too large, or bent.
std::optional<SensorAim::Disk> SensorAim::disk_of(const SensorEnd& sensor, const Space& space,
                                                  double largest) {
  constexpr double flat = 0.99;
  RandomStream random = stream_of_trials();
  std::vector<Vec3> places;
  Vec3 centre = Vec3::Zero(), outwards = Vec3::Zero();
  for (int i = 0; i < some; ++i) {
    const EndPosition at = sensor.sample_position(space, random, (i + 0.5) / some);
    places.push_back(at.point.x);
    centre += at.point.x / some;
    outwards -= at.inward / some;
  }
  double square = 0;
  for (const Vec3& place : places) square += (place - centre).squaredNorm() / some;
  const double radius = std::sqrt(square);
  if (!(outwards.norm() > flat && radius > 0 && radius < largest)) return std::nullopt;
  return Disk{centre, outwards.normalized(), radius};
}

SensorAim::SensorAim(std::vector<Disk> disks, const ScatteringMedium& medium, double bending)
    : disks_(std::move(disks)),
      mu_t_(medium.mu_t()),
      attenuation_(share_lost * medium.mu_t()),
      longest_(deepest / medium.mu_t()),
      bending_(share_kept * bending),
      turn_(1 - std::abs(medium.phase.mean_cosine())) {}

double SensorAim::usual(const Transport& transport, const Space& space) const {
  RandomStream random = stream_of_trials();
  double sum = 0;
  for (int i = 0; i < some; ++i) {
    const EndPosition at = transport.lights.sample_position(space, random);
    sum += worth(at.point.x, transport.lights.sample_direction(at, random).direction, 0);
  }
  return sum / some / parts;
}

PulledFlight SensorAim::first_flight(const Vec3& x, const Vec3& direction, double place) const {
  constexpr double bent = 1.02;  // longer than the straight way
  double depth = 0;
  for (const Disk& disk : disks_) {
    const double left = disk.outwards.dot(disk.centre - x), cosine = disk.outwards.dot(direction);
    if (cosine > 0) depth = std::max(depth, bent * mu_t_ * left / cosine);
  }
  return PulledFlight::at(place, std::min(depth, deepest / share_lost), share_lost);
}

double SensorAim::worth(const Vec3& x, const Vec3& direction, double turn) const {
  double most = 0;
  for (const Disk& disk : disks_) most = std::max(most, worth(disk, x, direction, turn));
  return most;
}

/// By where a straight way leads: to the sensor's plane, or some mean free paths on.
double SensorAim::worth(const Disk& disk, const Vec3& x, const Vec3& direction, double turn) const {
  const Vec3 to_centre = disk.centre - x;
  const double left = disk.outwards.dot(to_centre), cosine = disk.outwards.dot(direction);
  const double flight = left < longest_ * cosine ? left / cosine : longest_;
  const Vec3 off = to_centre - flight * direction;
  const double left_then = std::max(0.0, disk.outwards.dot(off));
  const double aside = (off - disk.outwards.dot(off) * disk.outwards).norm();
  const double reach =
      disk.radius + bending_ * left + turn * std::min(left, longest_) + spread * left_then;
  const double hits = reach / aside, share = hits < 1 ? std::max(hits * hits * hits, least) : 1;
  const double depth = attenuation_ * (cosine > 0 ? left : left_then);
  return share * std::exp(-std::min(depth, deepest));
}

PathKernel analog_kernel(std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const Space> space, std::optional<SensorAim> aim,
                         bool random_phase, std::shared_ptr<const MovingField> moving) {
  return [=](int paths, RandomStream& random, Film& film, TransportCounts& counts, JoinPromises*) {
    const SensorAim* const aimed = aim ? &*aim : nullptr;
    PathStreams streams(paths, random);
    if (!random_phase && space->has_lanes())
      return walk_in_lanes({*transport, *space, aimed, film, counts, moving.get()}, streams);
    while (auto own = streams.next()) {
      if (!random_phase) {
        walk({*transport, *space, aimed, film, counts, moving.get()}, *own);
        continue;
      }
      const auto met = space->frozen(2 * std::numbers::pi * own->random.uniform());
      walk({*transport, *met, aimed, film, counts, nullptr}, *own);
    }
  };
}

}  // namespace flatspeckle::grin
