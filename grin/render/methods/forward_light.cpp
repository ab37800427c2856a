#include "grin/render/methods/forward_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "grin/media/scattering/even_turns.h"
#include "grin/rays/marching/ray_lanes.h"
#include "grin/render/methods/moving_paths.h"
#include "grin/render/transport/light_tally.h"
#include "grin/render/transport/path_score.h"
#include "grin/render/transport/scrambled_sobol.h"
#include "grin/render/transport/split_tree.h"

namespace flatspeckle::grin {

namespace {

// Tuned on ultrasound waveguides in tissue of three mean free paths. A poor fit to another scene
// only increases the variance.
constexpr double share_lost = 0.7;  // share of light lost by scattering along a guide
// assumed spread of guided light, as a fraction of its largest angle
constexpr double share_kept = 0.6;
constexpr double spread = 0.5;      // spread in rad of light that scatters again before the sensor
constexpr double deepest = 3;       // largest depth ahead that is considered, in mean free paths
constexpr double least = 1.0 / 32;  // smallest importance; bounds the weight of light that returns

constexpr double parts = 2;  // initial number of branches of a path, which share its first flight

constexpr int some = 64;  // number of samples of positions on lights and sensors

RandomStream stream_of_trials() {
  return {0, static_cast<std::uint64_t>(Stream::render), 0};
}

/// Scene and accumulators shared by all paths of a batch.
struct ForwardBatch {
  const Transport& transport;
  const Space& space;
  const SensorTarget* target;
  Film& film;
  TransportCounts& counts;
  const MovingField* moving;
};

/// A path, or a branch of a split path. It has its own random stream and does not depend on other
/// paths, so that the results of similar scenes stay correlated.
struct Branch {
  RandomStream random;
  PathVertex from = {};
  Vec3 direction = Vec3::Zero();
  double power = 0;  ///< initial power of the path to which it belongs
  bool of_beam = false;
  UnsplitPath absorption = {};
  PathScore score = {};
  MomentumTransfer transfer = {};
  std::complex<double> modulation = 0;  ///< by the sound (TaggingSound)
  int flight = 0;                       ///< number of the current flight in MovingPaths
};

/// Start of a path: its random stream and its stratum in (0, 1) within the batch, from which the
/// first flight is sampled.
struct FreshPath {
  RandomStream random;
  double place;
};

/// Traces the paths of a batch. Each lane traces one branch; when that ends, it continues with a
/// waiting branch or starts the next path.
class ForwardWalk {
 public:
  struct Lane {
    EndPosition end;  ///< start of the first flight of its path
    std::optional<Branch> now;
  };
  /// Returns the start of the next path, if there is one.
  using Fresh = std::function<std::optional<FreshPath>()>;

  ForwardWalk(const ForwardBatch& batch, Fresh fresh)
      : batch_(batch), fresh_(std::move(fresh)), tally_(batch.film.energy) {
    if (batch.moving) moving_.emplace(*batch.moving, batch.film, batch.counts);
    const auto* variates = forward_controls(batch.transport, batch.target != nullptr);
    if (variates && !batch.film.sound()) controls_.emplace(*variates, batch.film.control_variates);
  }
  ~ForwardWalk() { tally_.end_path(); }

  /// Completes the derivatives after all paths.
  void finish() {
    if (moving_) moving_->finish();
  }

  /// Returns the next flight of a lane. flown: the last flight of the lane, or null.
  std::optional<Space::FlightStart> next(Lane& lane, const Flight* flown) {
    if (lane.now && !goes_on(*lane.now, *flown)) lane.now.reset();
    if (!lane.now) begin(lane);
    if (!lane.now) return std::nullopt;
    return Space::FlightStart{lane.now->from.point, lane.now->direction, &lane.now->random};
  }
  /// Returns the log that the control variates or the sound need of the next flight, or null.
  FlightLog* log() {
    if (!batch_.film.sound()) return controls_ ? controls_->log() : nullptr;
    log_.clear();
    return &log_;
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
    if (controls_) controls_->begin(now.from.point, now.direction);
    if (moving_)
      now.flight =
          moving_->begin(now.from.point.x, now.direction, lights.by_index(lane.end, now.direction));
    draw_flight(now, fresh.place);
  }
  /// Samples the length of the first flight of a path from its stratum `place`.
  void draw_flight(Branch& now, double place) {
    if (!batch_.target) return now.random.put_back(place);
    const ImportanceSampledFlight flight =
        batch_.target->first_flight(now.from.point.x, now.direction, place);
    now.random.put_back(flight.u);
    now.from.weight = reweighed(now.from.point, now.from.weight, flight.weight * now.from.weight);
  }
  /// Tallies a change of weight at a point; returns the new weight.
  double reweighed(const PathPoint& at, double before, double after) {
    tally_.reweighed(at.part, batch_.transport.medium(at.part).mu_a > 0, before - after);
    return after;
  }

  bool goes_on(Branch& now, const Flight& flight) {
    TransportCounts& counts = batch_.counts;
    counts.add_flight(flight.end == Flight::End::lost);
    if (controls_) controls_->flew(now.from.weight, now.from.weight, flight);
    if (flight.end == Flight::End::lost) {
      tally_.lost(now.from, flight);
      return false;
    }
    now.score.flew(flight.arc_length);
    if (const TaggingSound* const sound = batch_.film.sound())
      for (const FlightSegment& segment : log_)
        if (segment.start.part == sound->part)
          now.modulation += sound->flown(segment.start.x, segment.direction, segment.length);
    PathVertex next = moved(now.from, flight, batch_.space.index(flight.point));
    if (flight.end == Flight::End::boundary) {
      tally_.left(now.from, flight);
      if (!now.of_beam || next.vertices > 2 || batch_.film.sound())
        arrive(now, next, flight.arc_length);
      return false;
    }
    if (next.vertices - 2 >= batch_.transport.max_scatterings) {
      tally_.cut(now.from, flight);
      return false;
    }
    ++counts.light_collisions;
    const ScatteringMedium& medium = batch_.transport.medium(next.point);
    next.weight *= medium.albedo();
    const double before = next.weight;
    const bool survives =
        now.absorption.collide(now.from, flight, medium, next, now.random, counts, tally_);
    if (controls_) controls_->reweighed((survives ? next.weight : 0) - before);
    if (!survives) return false;
    now.from = next;
    if (batch_.target) return split(medium, now, flight.arc_length);
    turn(medium, flight.arc_length, medium.phase.sample(next.arrived, now.random), now);
    return next.weight > 0;
  }
  void turn(const ScatteringMedium& medium, double flown, const Vec3& direction, Branch& branch) {
    branch.direction = direction;
    if (controls_) controls_->turned(branch.from, direction);
    if (moving_)
      branch.flight =
          moving_->go_on(branch.flight, branch.from.point.x, branch.from.arrived, flown, direction);
    if (batch_.film.has_derivatives()) branch.score.turned(medium, branch.from.arrived, direction);
    if (batch_.film.has_decay())
      branch.transfer.turned(branch.from.point.part, branch.from.arrived, direction);
    if (const TaggingSound* const sound = batch_.film.sound();
        sound && branch.from.point.part == sound->part)
      branch.modulation += sound->turned(branch.from.point.x, branch.from.arrived, direction);
  }

  /// Splits a branch at a collision in proportion to its importance. Russian roulette favours
  /// branches that head for the sensors. Returns whether a branch is left.
  bool split(const ScatteringMedium& medium, Branch& now, double flown) {
    constexpr double most = 16;
    const Branch before = now;
    const PathVertex& from = before.from;
    const double importance =
        from.weight / now.power * batch_.target->before_turn(from.point.x, from.arrived);
    const double copies = std::clamp(std::round(importance), 1.0, most);
    EvenTurns turns(medium.phase, from.arrived, copies, now.random);
    EvenTermination roulette(now.random);
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
  /// Applies Russian roulette to a branch that leaves a collision along `direction`; returns its
  /// weight, 0 if it is terminated.
  double kept(const Branch& before, double weight, const Vec3& direction,
              EvenTermination& roulette) {
    const PathPoint& at = before.from.point;
    const double probability = weight / before.power * batch_.target->towards(at.x, direction);
    if (probability >= 1) return weight;
    return reweighed(at, weight, roulette.keeps(probability) ? weight / probability : 0);
  }

  void arrive(const Branch& now, const PathVertex& last, double flown) {
    if (moving_) moving_->land(now.flight, last.point.x, last.arrived, flown, last.weight);
    for (const SensorEnd& sensor : batch_.transport.sensors)
      sensor.hit(batch_.space, last.point.x, last.arrived, [&](const EndHit& hit) {
        const double value = last.weight * hit.value;
        deposit(batch_.film, batch_.counts, hit.direction.pixel, value, last.optical_path,
                now.transfer);
        batch_.film.add_hit(hit.direction.pixel, value);
        if (batch_.film.sound())
          batch_.film.add_sidebands(hit.direction.pixel, value, now.modulation);
        if (batch_.film.has_derivatives())
          now.score.add_to(batch_.film, hit.direction.pixel, value,
                           batch_.transport.medium(last.point.part));
      });
  }

  ForwardBatch batch_;
  Fresh fresh_;
  std::vector<Branch> waiting_;
  LightTally tally_;
  std::optional<MovingPaths> moving_;
  std::optional<PathControls> controls_;
  FlightLog log_;
};

/// Random streams of the paths of a batch.
class PathStreams {
 public:
  PathStreams(int paths, RandomStream& random)
      : key_{random.bits(), random.bits()},
        points_(light_points(random)),
        first_(random.uniform()),
        paths_(paths) {}

  std::optional<FreshPath> next() {
    if (next_ == paths_) return std::nullopt;
    const auto number = static_cast<std::uint64_t>(next_++);
    FreshPath path{{key_[0], key_[1], number}, (static_cast<double>(number) + first_) / paths_};
    path.random.lead(points_.point(number));
    return path;
  }

 private:
  std::uint64_t key_[2];
  ScrambledSobol points_;
  double first_;
  int paths_, next_ = 0;
};

void walk_in_lanes(const ForwardBatch& batch, PathStreams& streams) {
  ForwardWalk walk(batch, [&] { return streams.next(); });
  std::array<ForwardWalk::Lane, lanes> all;
  batch.space.fly_side_by_side([&](int lane, const Flight* flown) {
    return walk.next(all[static_cast<std::size_t>(lane)], flown);
  });
  walk.finish();
}

/// Traces one path.
void walk(const ForwardBatch& batch, const FreshPath& path) {
  std::optional<FreshPath> one = path;
  ForwardWalk walk(batch, [&] { return std::exchange(one, std::nullopt); });
  ForwardWalk::Lane lane;
  std::optional<Flight> flown;
  while (const auto start = walk.next(lane, flown ? &*flown : nullptr))
    flown = batch.space.fly(start->from, start->direction, *start->random, walk.log());
  walk.finish();
}

}  // namespace

const ControlVariates* forward_controls(const Transport& transport, bool has_target) {
  if (has_target || !transport.depth) return nullptr;
  const auto& variates = transport.depth->control_variates();
  return variates && variates->grows_little() ? &*variates : nullptr;
}

std::optional<SensorTarget> SensorTarget::of(const Transport& transport, const Space& space,
                                             double bending) {
  constexpr double small = 0.1;  // largest size of a sensor, relative to the stage
  const ScatteringMedium& medium = transport.stage.medium;
  if (!(medium.mu_s > 0)) return std::nullopt;
  const Box box = bounds(transport.stage.boundary);
  std::vector<Disk> disks;
  for (const SensorEnd& sensor : transport.sensors) {
    const auto disk = disk_of(sensor, space, small * (box.high - box.low).maxCoeff());
    if (!disk) return std::nullopt;
    disks.push_back(*disk);
  }
  SensorTarget target(std::move(disks), medium, bending);
  target.mean_importance_ = target.mean_importance(transport, space);
  return target;
}

/// Returns a disk with the standard deviation of the sensor's positions as radius; nullopt if it is
/// too large or not flat.
std::optional<SensorTarget::Disk> SensorTarget::disk_of(const SensorEnd& sensor, const Space& space,
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

SensorTarget::SensorTarget(std::vector<Disk> disks, const ScatteringMedium& medium, double bending)
    : disks_(std::move(disks)),
      mu_t_(medium.mu_t()),
      attenuation_(share_lost * medium.mu_t()),
      longest_(deepest / medium.mu_t()),
      bending_(share_kept * bending),
      turn_(1 - std::abs(medium.phase.mean_cosine())) {}

double SensorTarget::mean_importance(const Transport& transport, const Space& space) const {
  RandomStream random = stream_of_trials();
  double sum = 0;
  for (int i = 0; i < some; ++i) {
    const EndPosition at = transport.lights.sample_position(space, random);
    sum += importance(at.point.x, transport.lights.sample_direction(at, random).direction, 0);
  }
  return sum / some / parts;
}

ImportanceSampledFlight SensorTarget::first_flight(const Vec3& x, const Vec3& direction,
                                                   double place) const {
  constexpr double bent = 1.02;  // length of curved rays relative to the straight line
  double depth = 0;
  for (const Disk& disk : disks_) {
    const double left = disk.outwards.dot(disk.centre - x), cosine = disk.outwards.dot(direction);
    if (cosine > 0) depth = std::max(depth, bent * mu_t_ * left / cosine);
  }
  return ImportanceSampledFlight::at(place, std::min(depth, deepest / share_lost), share_lost);
}

double SensorTarget::importance(const Vec3& x, const Vec3& direction, double turn) const {
  double most = 0;
  for (const Disk& disk : disks_) most = std::max(most, importance(disk, x, direction, turn));
  return most;
}

/// Evaluates the importance at the end of a straight line, which ends on the sensor's plane or
/// after `deepest` mean free paths.
double SensorTarget::importance(const Disk& disk, const Vec3& x, const Vec3& direction,
                                double turn) const {
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

PathKernel forward_kernel(std::shared_ptr<const Transport> transport,
                          std::shared_ptr<const Space> space, std::optional<SensorTarget> target,
                          bool random_phase, std::shared_ptr<const MovingField> moving) {
  return [=](int paths, RandomStream& random, Film& film, TransportCounts& counts,
             ExpectedConnections*) {
    const SensorTarget* const used_target = target ? &*target : nullptr;
    PathStreams streams(paths, random);
    if (!random_phase && space->has_lanes())
      return walk_in_lanes({*transport, *space, used_target, film, counts, moving.get()}, streams);
    while (auto own = streams.next()) {
      if (!random_phase) {
        walk({*transport, *space, used_target, film, counts, moving.get()}, *own);
        continue;
      }
      const auto met = space->frozen(2 * std::numbers::pi * own->random.uniform());
      walk({*transport, *met, used_target, film, counts, nullptr}, *own);
    }
  };
}

}  // namespace flatspeckle::grin
