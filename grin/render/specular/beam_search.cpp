#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "grin/render/specular/passage_search.h"

namespace flatspeckle::grin {

namespace {

/// Ways of parallel light to a point, found backwards: rays from the point that arrive at a plane
/// against the light. What a trial mends is the direction of arrival; where on the plane that is
/// decides afterwards whether the light is there.
///
/// At the point the light has the irradiance, across its way, of the beam times Fresnel's and the
/// medium's transmittance over S = |det d(p_beam)/d(p_point)|, p = n times the unit tangent across
/// the ray: the map of transverse position and p along a ray is symplectic, so that neighbours
/// which are parallel in the beam lie 1/S as dense at the point.
class BeamSearch : PassageSearch<BeamSearch, BeamWay> {
 public:
  /// Refers to the space.
  BeamSearch(const Space& space, const PathPoint& to, const ParallelLight& light,
             const ConnectionOptions& options)
      : PassageSearch(Legs(space), to, Seek::reflections, options, 1e-9, 1e-14), light_(light) {}

  /// The ways that seeds lead to, and now and then a random one of the others with its multiplicity
  /// (C26): what seeds know varies by nothing, and what they miss is not lost.
  std::vector<BeamWay> find(std::span<const BeamSeed> seeds, RandomStream& random,
                            ConnectionStatistics& statistics) const {
    std::vector<BeamWay> ways;
    const auto add = [&](const Trial& trial) {
      if (trial.way && !is_among(ways, *trial.way)) ways.push_back(*trial.way);
    };
    add(along_light(random, statistics));
    for (const BeamSeed& seed : seeds) add(counted(from_here(seed), random, statistics));
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
    const Aim aim{direction, passages};
    const Shot shot = shoot(aim, random);
    return shot.is_ray ? judged(aim, shot).way : std::nullopt;
  }

 private:
  friend PassageSearch;
  static constexpr double others_share = 0.25;
  static constexpr double on_caustic = 1e-6;  // neighbours turn less than this times as they start

  Aim from_here(const BeamSeed& seed) const {
    const bool is_aimed = seed.passages.count > 0 && walk_.aims_at_bodies();
    return {is_aimed ? Vec3((seed.first_met - from_.x).normalized()) : seed.start_direction,
            seed.passages};
  }
  std::optional<BeamWay> one_of_others(std::span<const BeamWay> known, RandomStream& random,
                                       ConnectionStatistics& statistics) const {
    ++statistics.pairs;
    const auto draw = [&] { return at_random(random, statistics); };
    Trial first = draw();
    if (!first.way || is_among(known, *first.way)) return std::nullopt;
    ++statistics.found;
    first.way->multiplicity = multiplicity(*first.way, draw, random, statistics) / others_share;
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
    Aim aim{-light_.direction};
    Closest closest{aim};
    walk_.refracted(aim.direction, random,
                    [&](const Passages& met, Part part, const RayState& ray) {
                      closest(met, 0, squared_error(part, ray));
                    });
    return counted(aim, random, statistics);
  }
  /// The same; the leg that comes to the plane.
  Trial to_plane(RandomStream& random, ConnectionStatistics& statistics) const {
    Aim aim{-light_.direction};
    bool is_there = false;
    walk_.refracted(
        aim.direction, random, [&](const Passages& met, Part part, const RayState& ray) {
          RayState end = ray;
          const PlaneCrossing crossing = legs_.to_plane(part, light_, end, nullptr);
          if (is_there || !crossing.is_reached || !legs_.stays(part, ray, crossing.sigma)) return;
          is_there = true;
          aim.passages = met;
        });
    if (is_there) return counted(aim, random, statistics);
    statistics.add(TrialOutcome::no_approach);
    return {TrialOutcome::no_approach};
  }
  Trial at_random(RandomStream& random, ConnectionStatistics& statistics) const {
    Aim aim{walk_.start_direction(-light_.direction, options_.start, random)};
    Drawn drawn{aim, 1e-4, random};
    walk_.at_random(aim.direction, random,
                    [&](const Passages& met, Part part, const RayState& ray) {
                      if (met.count > 0 || !walk_.aims_at_bodies())  // else along_light finds it
                        drawn(met, 0, squared_error(part, ray));
                    });
    return counted(aim, random, statistics);
  }
  /// Of a leg that starts so.
  double squared_error(Part part, RayState ray) const {
    legs_.to_plane(part, light_, ray, nullptr);
    return (ray.v.normalized() + light_.direction).squaredNorm();
  }

  void land(const Aim&, Shot& shot) const {
    shot.crossing = legs_.to_plane(shot.head.part, light_, shot.end, &shot.tangent);
    shot.error = shot.end.v.normalized() + light_.direction;
  }
  /// How the direction of arrival turns with that of the start.
  Mat2 map(const Aim& aim, const Shot& shot) const {
    return frame_across(shot.end.v).transpose() * shot.tangent.dv * frame_across(aim.direction) *
           (legs_.index(from_) / shot.end.v.norm());
  }
  Aim moved(const Aim& aim, const Shot& shot, DampedStep& damped) const {
    const Frame moved = frame_across(shot.end.v) * map(aim, shot);
    Aim next = aim;
    next.direction = turned(
        aim.direction, damped({moved.col(0), moved.col(1), shot.end.v.normalized()}, shot.error));
    return next;
  }

  Trial judged(const Aim& aim, const Shot& shot) const {
    if (!shot.crossing.is_reached ||
        !legs_.stays(shot.head.part, shot.head.ray, shot.crossing.sigma))
      return {TrialOutcome::left_region};
    if (shot.end.arc_length > options_.max_length) return {TrialOutcome::too_long};
    const Mat2 map = this->map(aim, shot);
    if (widths(map).narrow < on_caustic) return {TrialOutcome::degenerate};
    const double index_ratio = shot.end.v.norm() / legs_.index(from_);
    const double determinant = map.determinant();
    return {TrialOutcome::converged,
            BeamWay{.start_direction = aim.direction,
                    .place = shot.end.x,
                    .first_met = shot.head.first_met,
                    .thinning = index_ratio * index_ratio * std::abs(determinant),
                    .orientation = determinant < 0 ? -1 : 1,
                    .arc_length = shot.end.arc_length,
                    .optical_path = shot.end.optical_path,
                    .passages = aim.passages,
                    .transmittance = shot.head.chance,
                    .multiplicity = 1}};
  }

  ParallelLight light_;
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
