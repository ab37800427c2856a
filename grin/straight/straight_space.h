#pragma once

#include "grin/space/flight_log.h"
#include "grin/straight/straight_legs.h"
#include "grin/ways/beam_search.h"
#include "grin/ways/way_search.h"

namespace flatspeckle::grin {

/// Space where the index is the same everywhere in a part: flights and joins are straight within
/// it, in closed form.
template <RenderPlan plan>
class StraightSpace {
  static_assert(!plan.curved);

 public:
  /// field_excess: of the part that the field fills.
  StraightSpace(const Stage& stage, double field_excess) : stage_(stage, field_excess) {}

  double index(const PathPoint& p) const { return 1 + stage_.excess(p.part); }

  /// log: its legs are added to that. rise: the first leg is stretched along it (StraightStage).
  Flight fly(const PathPoint& from, const Vec3& direction, RandomStream& random,
             FlightLog* log = nullptr, const Vec3* rise = nullptr) const {
    Flight flight{.point = from, .start_direction = direction, .direction = direction};
    const LegEnd end = leg(flight, random, log, rise);
    if (plan.body && end > at_boundary)
      return joins_all() ? go_on(flight, end, random, log) : refracted(flight, end, random, log);
    flight.spreading = flight.arc_length * flight.arc_length;
    return finished(flight, end);
  }

  /// Of a leg of a flight (flight_log.h).
  template <class Use>
  void for_points(const FlightLeg& leg, double apart, RandomStream& random, const Use& use) const {
    const auto x_at = [&](double s) -> Vec3 { return leg.start.x + s * leg.direction; };
    grin::for_points(leg, stage_.medium(leg.start.part), apart, random, x_at, use);
  }

  /// All ways of light between two points.
  bool joins_all() const { return !stage_.refracts(); }
  /// Any, between points of these parts.
  bool can_join(const PathPoint& p, const PathPoint& q) const {
    return stage_.are_alike(p.part, q.part) || joins_through();
  }
  double least_depth(const PathPoint& p, const PathPoint& q) const {
    return stage_.least_depth(p, q);
  }
  std::optional<Join> join(const PathPoint& p, const PathPoint& q, RandomStream& random,
                           ConnectionStatistics&) const {
    return stage_.join(p, q, random);
  }
  bool joins_through() const { return stage_.refracts(); }
  std::optional<Join> join_through(const PathPoint& p, const PathPoint& q, RandomStream& random,
                                   ConnectionStatistics& statistics) const {
    if (!joins_through()) return std::nullopt;
    return join_by_way(legs(), p, q, search, random, statistics);
  }

  std::vector<BeamWay> ways_to_beam(const PathPoint& p, const ParallelLight& light,
                                    std::span<const BeamSeed> seeds, RandomStream& random,
                                    ConnectionStatistics& statistics) const {
    if (joins_through())
      return BeamSearch(legs(), p, light, search).find(seeds, random, statistics);
    if (const auto way = stage_.way_to_beam(p, light, random)) return {*way};
    return {};
  }
  std::optional<BeamWay> plainest_way_to_beam(const PathPoint& p, const ParallelLight& light,
                                              RandomStream& random,
                                              ConnectionStatistics& statistics) const {
    if (joins_through())
      return BeamSearch(legs(), p, light, search).find_plainest(random, statistics);
    return stage_.way_to_beam(p, light, random);
  }
  std::optional<BeamWay> some_way_to_beam(const PathPoint& p, const ParallelLight& light,
                                          RandomStream& random,
                                          ConnectionStatistics& statistics) const {
    if (!joins_through()) return std::nullopt;
    return BeamSearch(legs(), p, light, search).find_one(random, statistics);
  }
  std::optional<BeamWay> beam_way(const PathPoint& p, const ParallelLight& light,
                                  const Vec3& direction, const Passages& passages,
                                  RandomStream& random) const {
    return BeamSearch(legs(), p, light, search).along(direction, passages, random);
  }

 private:
  static inline const ConnectionOptions search{
      .step = 1,
      .max_length = std::numeric_limits<double>::infinity(),
      .start = {.chord_share = 0.3},
      .max_iterations = 20};
  StraightLegs<plan> legs() const { return StraightLegs<plan>(stage_); }
  IndexGradient side(Part part) const { return {stage_.excess(part), Vec3::Zero()}; }

  LegEnd leg(Flight& flight, RandomStream& random, FlightLog* log,
             const Vec3* rise = nullptr) const {
    FlightLeg now{flight.point, flight.direction, flight.arc_length, flight.weight};
    const LegEnd end = stage_.fly(flight, random, rise);
    if (log) {
      now.length = flight.arc_length - now.length;
      log->push_back(now);
    }
    return end;
  }
  /// At the surface of a body.
  Flight& go_on(Flight& flight, LegEnd end, RandomStream& random, FlightLog* log) const {
    for (int legs = 1; legs < stage_.regions().most_legs(); ++legs) {
      stage_.pass(flight, stage_.beyond(flight, end));
      end = leg(flight, random, log);
      if (end > at_boundary) continue;
      flight.spreading = flight.arc_length * flight.arc_length;
      return finished(flight, end);
    }
    return flight;  // lost
  }
  Flight& refracted(Flight& flight, LegEnd end, RandomStream& random, FlightLog* log) const {
    const double n_start = index(flight.point);
    RayTangent tangent;
    tangent.dx.diagonal().fill(flight.arc_length / n_start);
    for (int legs = 1; legs < stage_.regions().most_legs(); ++legs) {
      cross(flight, end, tangent, random);
      const double before = flight.arc_length, n = index(flight.point);
      end = leg(flight, random, log);
      tangent.dx += (flight.arc_length - before) / n * tangent.dv;
      if (end > at_boundary) continue;
      if (flight.is_joinable)
        flight.spreading =
            std::abs(signed_spreading(tangent, n_start, flight.start_direction, flight.direction));
      return finished(flight, end);
    }
    return flight;  // lost
  }
  void cross(Flight& flight, LegEnd surface, RayTangent& tangent, RandomStream& random) const {
    const Part from = flight.point.part, to = stage_.beyond(flight, surface);
    if (stage_.are_alike(from, to)) return stage_.pass(flight, to);
    stage_.cross(flight, surface, to, {side(from), side(to)}, &tangent, random);
  }
  static Flight& finished(Flight& flight, LegEnd end) {
    flight.end = end == at_collision ? Flight::End::collision : Flight::End::boundary;
    return flight;
  }

  StraightStage<plan> stage_;
};

}  // namespace flatspeckle::grin
