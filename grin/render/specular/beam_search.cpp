#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "grin/render/specular/crossing_search.h"

namespace flatspeckle::grin {

namespace {

/// Search for connections from a point to parallel light. Connections are traced backwards, as rays
/// from the point that arrive at the plane of the light in the direction opposite to the light. A
/// trial starts from a ray and corrects its direction of arrival. Whether the beam covers the
/// position on the plane is checked afterwards by the caller.
///
/// The irradiance at the point, on an area normal to the ray, is that of the beam times Fresnel
/// probability and transmittance of the media, divided by S = |det d(p_beam)/d(p_point)|. Here p is
/// the component normal to the ray of n times the unit tangent of a neighbouring ray. The reason is
/// that the map of transverse position and p along a ray is symplectic: rays that are parallel in
/// the beam have 1/S times their density at the point.
class BeamSearch : CrossingSearch<BeamSearch, BeamConnection> {
 public:
  /// Holds a reference to the space.
  BeamSearch(const Space& space, const PathPoint& to, const ParallelLight& light,
             const ConnectionOptions& options)
      : CrossingSearch(Segments(space), to, Seek::reflections, options, 1e-9, 1e-14),
        light_(light) {}

  /// Returns the connections to which the seeds lead and, with probability others_share, one other
  /// connection, found at random, with its multiplicity (C26). Connections from seeds add no
  /// variance, and the random one avoids a bias due to connections that the seeds miss.
  std::vector<BeamConnection> find(std::span<const BeamSeed> seeds, RandomStream& random,
                                   ConnectionStatistics& statistics) const {
    std::vector<BeamConnection> connections;
    const auto add = [&](const Trial& trial) {
      if (trial.found && !is_among(connections, *trial.found)) connections.push_back(*trial.found);
    };
    add(along_light(random, statistics));
    for (const BeamSeed& seed : seeds) add(counted(from_here(seed), random, statistics));
    if (random.uniform() < others_share)
      if (auto other = one_of_others(connections, random, statistics))
        connections.push_back(*other);
    for (BeamConnection& connection : connections) attenuate(connection, random);
    return connections;
  }

  /// Returns the connection found by a trial from the ray that starts opposite to the light and is
  /// refracted wherever possible. The result is deterministic.
  std::optional<BeamConnection> find_plainest(RandomStream& random,
                                              ConnectionStatistics& statistics) const {
    Trial trial = to_plane(random, statistics);
    if (trial.found) attenuate(*trial.found, random);
    return trial.found;
  }

  /// Returns the result of one random trial.
  std::optional<BeamConnection> find_one(RandomStream& random,
                                         ConnectionStatistics& statistics) const {
    return at_random(random, statistics, nullptr).found;
  }

  /// Returns the connection with this start direction and these crossings; nullopt if there is no
  /// connection that find() would accept.
  std::optional<BeamConnection> along(const Vec3& direction, const InterfaceCrossings& crossings,
                                      RandomStream& random) const {
    const Aim aim{direction, crossings};
    const Shot shot = shoot(aim, random);
    return shot.is_ray ? judged(aim, shot).found : std::nullopt;
  }

 private:
  friend CrossingSearch;
  static constexpr double others_share = 0.25;
  // ratio of turns of end and start direction below which a connection counts as on a caustic
  static constexpr double on_caustic = 1e-6;

  Aim from_here(const BeamSeed& seed) const {
    const bool is_aimed = seed.crossings.count > 0 && walk_.aims_at_bodies();
    return {is_aimed ? Vec3((seed.first_met - from_.x).normalized()) : seed.start_direction,
            seed.crossings};
  }
  std::optional<BeamConnection> one_of_others(std::span<const BeamConnection> known,
                                              RandomStream& random,
                                              ConnectionStatistics& statistics) const {
    ++statistics.pairs;
    const auto draw = [&](const InterfaceCrossings* wanted) {
      return at_random(random, statistics, wanted);
    };
    Trial first = draw(nullptr);
    if (!first.found || is_among(known, *first.found)) return std::nullopt;
    ++statistics.found;
    first.found->multiplicity = multiplicity(*first.found, draw, random, statistics) / others_share;
    return first.found;
  }
  void attenuate(BeamConnection& connection, RandomStream& random) const {
    connection.optical_depth = -std::log(connection.transmittance);
    walk_.for_each_segment(connection.start_direction, connection.crossings, connection.arc_length,
                           random, [&](Part part, const RayState& start, double length) {
                             connection.transmittance *=
                                 segments_.transmitted(part, start, length, random);
                             connection.optical_depth += segments_.reference(part) * length;
                           });
  }
  bool is_among(std::span<const BeamConnection> connections, const BeamConnection& one) const {
    return std::any_of(connections.begin(), connections.end(),
                       [&](const BeamConnection& connection) { return same(connection, one); });
  }
  bool same(const BeamConnection& a, const BeamConnection& b) const {
    return a.crossings == b.crossings && a.orientation == b.orientation &&
           (a.start_direction - b.start_direction).norm() <= options_.same;
  }

  /// Runs a trial from the ray that starts opposite to the light and is refracted wherever
  /// possible. The trial uses the crossings up to the segment whose direction at the plane of the
  /// light is closest to the direction opposite to the light.
  Trial along_light(RandomStream& random, ConnectionStatistics& statistics) const {
    Aim aim{-light_.direction};
    Closest closest{aim};
    walk_.refracted(aim.direction, random,
                    [&](const InterfaceCrossings& met, Part part, const RayState& ray) {
                      closest(met, 0, squared_error(part, ray));
                    });
    return counted(aim, random, statistics);
  }
  /// Runs a trial from the ray that starts opposite to the light and is refracted wherever
  /// possible. The trial uses the crossings up to the first segment that reaches the plane of the
  /// light.
  Trial to_plane(RandomStream& random, ConnectionStatistics& statistics) const {
    Aim aim{-light_.direction};
    bool is_there = false;
    walk_.refracted(
        aim.direction, random, [&](const InterfaceCrossings& met, Part part, const RayState& ray) {
          RayState end = ray;
          const PlaneCrossing crossing = segments_.to_plane(part, light_, end, nullptr);
          if (is_there || !crossing.is_reached || !segments_.stays(part, ray, crossing.sigma))
            return;
          is_there = true;
          aim.crossings = met;
        });
    if (is_there) return counted(aim, random, statistics);
    return missed(statistics);
  }
  /// wanted: the only crossings of interest, or null; see multiplicity().
  Trial at_random(RandomStream& random, ConnectionStatistics& statistics,
                  const InterfaceCrossings* wanted) const {
    Aim aim{walk_.start_direction(-light_.direction, options_.start, random)};
    Drawn drawn{aim, 1e-4, random};
    walk_.at_random(
        aim.direction, random, [&](const InterfaceCrossings& met, Part part, const RayState& ray) {
          if (met.count > 0 ||
              !walk_.aims_at_bodies())  // connections without crossings are left to along_light()
            drawn(met, 0, squared_error(part, ray));
        });
    if (wanted && aim.crossings != *wanted) return missed(statistics);
    return counted(aim, random, statistics);
  }
  /// Returns the squared difference between the direction in which a segment that starts with `ray`
  /// meets the plane of the light, and the direction opposite to the light.
  double squared_error(Part part, RayState ray) const {
    segments_.to_plane(part, light_, ray, nullptr);
    return (ray.v.normalized() + light_.direction).squaredNorm();
  }

  void land(const Aim&, Shot& shot) const {
    shot.crossing = segments_.to_plane(shot.head.part, light_, shot.end, &shot.tangent);
    shot.error = shot.end.v.normalized() + light_.direction;
  }
  /// Returns the derivative of the arrival direction with respect to the start direction.
  Mat2 map(const Aim& aim, const Shot& shot) const {
    return frame_across(shot.end.v).transpose() * shot.tangent.dv * frame_across(aim.direction) *
           (segments_.index(from_) / shot.end.v.norm());
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
        !segments_.stays(shot.head.part, shot.head.ray, shot.crossing.sigma))
      return {TrialOutcome::left_region};
    if (shot.end.arc_length > options_.max_length) return {TrialOutcome::too_long};
    const Mat2 map = this->map(aim, shot);
    if (widths(map).narrow < on_caustic) return {TrialOutcome::degenerate};
    const double index_ratio = shot.end.v.norm() / segments_.index(from_);
    const double determinant = map.determinant();
    return {TrialOutcome::converged,
            BeamConnection{.start_direction = aim.direction,
                           .place = shot.end.x,
                           .first_met = shot.head.first_met,
                           .thinning = index_ratio * index_ratio * std::abs(determinant),
                           .orientation = determinant < 0 ? -1 : 1,
                           .arc_length = shot.end.arc_length,
                           .optical_path = shot.end.optical_path,
                           .crossings = aim.crossings,
                           .transmittance = shot.head.probability,
                           .multiplicity = 1}};
  }

  ParallelLight light_;
};

}  // namespace

std::vector<BeamConnection> Space::connections_to_beam(const PathPoint& p,
                                                       const ParallelLight& light,
                                                       std::span<const BeamSeed> seeds,
                                                       RandomStream& random,
                                                       ConnectionStatistics& statistics) const {
  if (searches_for_beams())
    return BeamSearch(*this, p, light, setup_->search).find(seeds, random, statistics);
  if (const auto connection = simplest_connection_to_beam(p, light, random, statistics))
    return {*connection};
  return {};
}

std::optional<BeamConnection> Space::simplest_connection_to_beam(
    const PathPoint& p, const ParallelLight& light, RandomStream& random,
    ConnectionStatistics& statistics) const {
  if (searches_for_beams())
    return BeamSearch(*this, p, light, setup_->search).find_plainest(random, statistics);
  if (is_curved(p.part)) return std::nullopt;
  return setup_->stage.connection_to_beam(p, light, random);
}

std::optional<BeamConnection> Space::some_connection_to_beam(
    const PathPoint& p, const ParallelLight& light, RandomStream& random,
    ConnectionStatistics& statistics) const {
  if (!searches_for_beams()) return std::nullopt;
  return BeamSearch(*this, p, light, setup_->search).find_one(random, statistics);
}

std::optional<BeamConnection> Space::beam_connection(const PathPoint& p, const ParallelLight& light,
                                                     const Vec3& direction,
                                                     const InterfaceCrossings& crossings,
                                                     RandomStream& random) const {
  return BeamSearch(*this, p, light, setup_->search).along(direction, crossings, random);
}

}  // namespace flatspeckle::grin
