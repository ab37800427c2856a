#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "grin/rays/connections/connection_solver.h"
#include "grin/rays/connections/damped_step.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/render/specular/passage_walk.h"
#include "grin/render/specular/way.h"

namespace flatspeckle::grin {

namespace {

/// Ways of parallel light to a point, found backwards: rays from the point that arrive at a plane
/// against the light. As WaySearch, but what a trial mends by damped Gauss-Newton steps is the
/// direction of arrival; where on the plane that is decides afterwards whether the light is there.
///
/// At the point the light has the irradiance, across its way, of the beam times Fresnel's and the
/// medium's transmittance over S = |det d(p_beam)/d(p_point)|, p = n times the unit tangent across
/// the ray: the map of transverse position and p along a ray is symplectic, so that neighbours
/// which are parallel in the beam lie 1/S as dense at the point.
class BeamSearch {
 public:
  /// Refers to the space.
  BeamSearch(const Space& space, const PathPoint& to, const ParallelLight& light,
             const ConnectionOptions& options)
      : legs_(space),
        walk_(legs_, to, Seek::reflections),
        light_(light),
        options_(options),
        to_(to) {}

  /// The ways that seeds lead to, and now and then a random one of the others with its multiplicity
  /// (C26): what seeds know varies by nothing, and what they miss is not lost.
  std::vector<BeamWay> find(std::span<const BeamSeed> seeds, RandomStream& random,
                            ConnectionStatistics& statistics) const {
    std::vector<BeamWay> ways;
    const auto add = [&](const Trial& trial) {
      if (trial.way && !is_among(ways, *trial.way)) ways.push_back(*trial.way);
    };
    add(along_light(random, statistics));
    for (const BeamSeed& seed : seeds)
      add(counted(refined(from_here(seed), random, statistics), statistics));
    if (random.uniform() < others_share)
      if (auto other = one_of_others(ways, random, statistics)) ways.push_back(*other);
    for (BeamWay& way : ways) attenuate(way, random);
    return ways;
  }

  /// The way that a ray against the light leads to, refracted wherever it can be: where there is
  /// one, always the same.
  std::optional<BeamWay> find_plainest(RandomStream& random,
                                       ConnectionStatistics& statistics) const {
    Trial trial = to_plane(random, statistics);
    if (trial.way) attenuate(*trial.way, random);
    return trial.way;
  }

  /// What one random trial finds.
  std::optional<BeamWay> find_one(RandomStream& random, ConnectionStatistics& statistics) const {
    return at_random(random, statistics).way;
  }

  /// The way that starts so and takes these passages; nothing where `find` finds none there.
  std::optional<BeamWay> along(const Vec3& direction, const Passages& passages,
                               RandomStream& random) const {
    const BeamSeed aim{direction, passages};
    const Shot shot = shoot(aim, random);
    return shot.is_ray ? judged(aim, shot).way : std::nullopt;
  }

 private:
  static constexpr double close = 1e-9;  // rad, of the direction of arrival
  static constexpr double others_share = 0.25;
  static constexpr double on_caustic = 1e-6;  // neighbours turn less than this times as they start

  struct Shot {
    bool is_ray = false;  // goes through the passages
    PassageWalk::Head last;
    PlaneCrossing crossing;
    RayState end;
    RayTangent tangent = {};
    Vec3 error;  // of the direction of arrival
    double miss;
  };
  struct Trial {
    TrialOutcome outcome;
    std::optional<BeamWay> way = {};
  };

  BeamSeed from_here(BeamSeed seed) const {
    if (seed.passages.count > 0 && walk_.aims_at_bodies())
      seed.start_direction = (seed.first_met - to_.x).normalized();
    return seed;
  }
  std::optional<BeamWay> one_of_others(std::span<const BeamWay> known, RandomStream& random,
                                       ConnectionStatistics& statistics) const {
    ++statistics.pairs;
    Trial first = at_random(random, statistics);
    if (!first.way || is_among(known, *first.way)) return std::nullopt;
    ++statistics.found;
    const auto refinds = [&] {
      const Trial again = at_random(random, statistics);
      return again.way && same(*first.way, *again.way);
    };
    first.way->multiplicity =
        trials_to_refind(refinds, options_.roulette_after, random, statistics) / others_share;
    return first.way;
  }
  void attenuate(BeamWay& way, RandomStream& random) const {
    way.optical_depth = -std::log(way.transmittance);
    walk_.for_each_leg(way.start_direction, way.passages, way.arc_length, random,
                       [&](Part part, const RayState& start, double length) {
                         way.transmittance *= legs_.transmitted(part, start, length, random);
                         way.optical_depth += legs_.reference(part) * length;
                       });
  }
  bool is_among(std::span<const BeamWay> ways, const BeamWay& one) const {
    return std::any_of(ways.begin(), ways.end(),
                       [&](const BeamWay& way) { return same(way, one); });
  }
  bool same(const BeamWay& a, const BeamWay& b) const {
    return a.passages == b.passages && a.orientation == b.orientation &&
           (a.start_direction - b.start_direction).norm() <= options_.same;
  }

  /// Refracted wherever that can be; the leg that comes closest to the direction.
  Trial along_light(RandomStream& random, ConnectionStatistics& statistics) const {
    BeamSeed aim{-light_.direction};
    double closest = std::numeric_limits<double>::infinity();
    walk_.refracted(aim.start_direction, random,
                    [&](const Passages& met, Part part, const RayState& ray) {
                      const double square = squared_error(part, ray);
                      if (!(square < closest)) return;
                      closest = square;
                      aim.passages = met;
                    });
    return counted(refined(aim, random, statistics), statistics);
  }
  /// The same; the leg that comes to the plane.
  Trial to_plane(RandomStream& random, ConnectionStatistics& statistics) const {
    BeamSeed aim{-light_.direction};
    bool is_there = false;
    walk_.refracted(
        aim.start_direction, random, [&](const Passages& met, Part part, const RayState& ray) {
          RayState end = ray;
          const PlaneCrossing crossing = legs_.to_plane(part, light_, end, nullptr);
          if (is_there || !crossing.is_reached || !legs_.stays(part, ray, crossing.sigma)) return;
          is_there = true;
          aim.passages = met;
        });
    if (!is_there) return counted({TrialOutcome::no_approach}, statistics);
    return counted(refined(aim, random, statistics), statistics);
  }
  Trial at_random(RandomStream& random, ConnectionStatistics& statistics) const {
    BeamSeed aim{walk_.start_direction(-light_.direction, options_.start, random)};
    double total = 0;
    walk_.at_random(aim.start_direction, random,
                    [&](const Passages& met, Part part, const RayState& ray) {
                      if (met.count == 0 && walk_.aims_at_bodies()) return;  // along_light finds it
                      const double weight = 1 / (squared_error(part, ray) + 1e-4);
                      total += weight;
                      if (random.uniform() * total <= weight) aim.passages = met;
                    });
    return counted(refined(aim, random, statistics), statistics);
  }
  static Trial counted(const Trial& trial, ConnectionStatistics& statistics) {
    ++statistics.outcomes[static_cast<int>(trial.outcome)];
    return trial;
  }
  /// Of a leg that starts so.
  double squared_error(Part part, RayState ray) const {
    legs_.to_plane(part, light_, ray, nullptr);
    return (ray.v.normalized() + light_.direction).squaredNorm();
  }

  Shot shoot(const BeamSeed& aim, RandomStream& random) const {
    Shot shot;
    const auto head = walk_.follow(aim.start_direction, aim.passages, &shot.tangent, random);
    if (!head) return shot;
    shot.is_ray = true;
    shot.last = *head;
    shot.end = head->ray;
    shot.crossing = legs_.to_plane(head->part, light_, shot.end, &shot.tangent);
    shot.error = shot.end.v.normalized() + light_.direction;
    shot.miss = shot.error.norm();
    return shot;
  }

  Trial refined(BeamSeed aim, RandomStream& random, ConnectionStatistics& statistics) const {
    Shot shot = shoot(aim, random);
    if (!shot.is_ray) return {TrialOutcome::no_approach};
    DampedStep damped;
    for (int i = 0; i < options_.max_iterations && !damped.stuck(); ++i) {
      if (arrived(aim, shot)) return judged(aim, shot);
      const BeamSeed next = moved(aim, shot, damped);
      const Shot tried = shoot(next, random);
      ++statistics.iterations;
      if (tried.is_ray && tried.miss < shot.miss) {
        damped.succeeded(tried.miss / shot.miss);
        aim = next;
        shot = tried;
      } else {
        damped.failed();
      }
    }
    return {TrialOutcome::not_converged};
  }

  /// How the direction of arrival turns with that of the start.
  Mat2 turns(const BeamSeed& aim, const Shot& shot) const {
    return frame_across(shot.end.v).transpose() * shot.tangent.dv *
           frame_across(aim.start_direction) * (legs_.index(to_) / shot.end.v.norm());
  }
  /// The end is where it should be, and so well that the start is known.
  bool arrived(const BeamSeed& aim, const Shot& shot) const {
    constexpr double rounding = 1e-14;
    return shot.miss <= close &&
           shot.miss <= std::max(rounding, options_.same / 10 * widths(turns(aim, shot)).narrow);
  }
  BeamSeed moved(const BeamSeed& aim, const Shot& shot, DampedStep& damped) const {
    const Frame moved = frame_across(shot.end.v) * turns(aim, shot);
    BeamSeed next = aim;
    next.start_direction =
        turned(aim.start_direction,
               damped({moved.col(0), moved.col(1), shot.end.v.normalized()}, shot.error));
    return next;
  }

  Trial judged(const BeamSeed& aim, const Shot& shot) const {
    if (!shot.crossing.is_reached ||
        !legs_.stays(shot.last.part, shot.last.ray, shot.crossing.sigma))
      return {TrialOutcome::left_region};
    if (shot.end.arc_length > options_.max_length) return {TrialOutcome::too_long};
    const Mat2 map = turns(aim, shot);
    if (widths(map).narrow < on_caustic) return {TrialOutcome::degenerate};
    const double index_ratio = shot.end.v.norm() / legs_.index(to_);
    const double determinant = map.determinant();
    return {TrialOutcome::converged,
            BeamWay{.start_direction = aim.start_direction,
                    .place = shot.end.x,
                    .first_met = shot.last.first_met,
                    .thinning = index_ratio * index_ratio * std::abs(determinant),
                    .orientation = determinant < 0 ? -1 : 1,
                    .arc_length = shot.end.arc_length,
                    .optical_path = shot.end.optical_path,
                    .passages = aim.passages,
                    .transmittance = shot.last.chance,
                    .multiplicity = 1}};
  }

  Legs legs_;
  PassageWalk walk_;
  ParallelLight light_;
  const ConnectionOptions& options_;
  PathPoint to_;
};

}  // namespace

std::vector<BeamWay> Space::ways_to_beam(const PathPoint& p, const ParallelLight& light,
                                         std::span<const BeamSeed> seeds, RandomStream& random,
                                         ConnectionStatistics& statistics) const {
  if (searches_for_beams())
    return BeamSearch(*this, p, light, setup_->search).find(seeds, random, statistics);
  if (const auto way = plainest_way_to_beam(p, light, random, statistics)) return {*way};
  return {};
}

std::optional<BeamWay> Space::plainest_way_to_beam(const PathPoint& p, const ParallelLight& light,
                                                   RandomStream& random,
                                                   ConnectionStatistics& statistics) const {
  if (searches_for_beams())
    return BeamSearch(*this, p, light, setup_->search).find_plainest(random, statistics);
  if (is_curved(p.part)) return std::nullopt;
  return setup_->stage.way_to_beam(p, light, random);
}

std::optional<BeamWay> Space::some_way_to_beam(const PathPoint& p, const ParallelLight& light,
                                               RandomStream& random,
                                               ConnectionStatistics& statistics) const {
  if (!searches_for_beams()) return std::nullopt;
  return BeamSearch(*this, p, light, setup_->search).find_one(random, statistics);
}

std::optional<BeamWay> Space::beam_way(const PathPoint& p, const ParallelLight& light,
                                       const Vec3& direction, const Passages& passages,
                                       RandomStream& random) const {
  return BeamSearch(*this, p, light, setup_->search).along(direction, passages, random);
}

}  // namespace flatspeckle::grin
