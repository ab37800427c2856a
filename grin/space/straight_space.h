#pragma once

#include "grin/space/straight_stage.h"

namespace flatspeckle::grin {

/// Space where the index is the same everywhere in a part: flights and joins are straight within
/// it, in closed form.
template <RenderPlan plan>
class StraightSpace {
  static_assert(!plan.curved);

 public:
  /// field_excess: of the body where there is one, of the whole stage otherwise.
  StraightSpace(const Stage& stage, double field_excess)
      : stage_(stage), excess_{stage.body ? stage.excess_around : field_excess, field_excess} {}

  double index(const PathPoint& p) const { return 1 + excess(p.part); }

  Flight fly(const PathPoint& from, const Vec3& direction, RandomStream& random) const {
    Flight flight{.point = from, .start_direction = direction, .direction = direction};
    if constexpr (plan.body) {
      for (int leg = 0; leg < most_legs; ++leg) {
        const LegEnd end = stage_.fly(flight, index(flight.point), random);
        if (end != LegEnd::body) return finished(flight, end);
        stage_.cross(flight, excess(Part::body), excess(Part::stage), random);
      }
      return flight;  // lost
    }
    return finished(flight, stage_.fly(flight, index(from), random));
  }

  /// All ways of light between two points.
  bool joins_all() const { return !plan.body || is_clear(); }
  /// Any, between points of these parts.
  bool can_join(const PathPoint& p, const PathPoint& q) const {
    return p.part == q.part || is_clear();
  }
  double least_depth(const PathPoint& p, const PathPoint& q) const {
    return stage_.least_depth(p, q);
  }
  std::optional<Join> join(const PathPoint& p, const PathPoint& q, RandomStream& random,
                           ConnectionStatistics&) const {
    if (is_clear()) return stage_.join_through(p, q, index(p), random);
    return stage_.join(p, q, index(p), random);
  }

 private:
  double excess(Part part) const { return excess_[plan.body && part == Part::body ? 1 : 0]; }

  /// Nothing is refracted at the body's surface.
  bool is_clear() const { return plan.body && excess_[0] == excess_[1]; }

  static Flight& finished(Flight& flight, LegEnd end) {
    flight.end = end == LegEnd::collision ? Flight::End::collision : Flight::End::boundary;
    if (flight.is_joinable) flight.spreading = flight.arc_length * flight.arc_length;
    return flight;
  }

  StraightStage<plan> stage_;
  double excess_[2];
};

}  // namespace flatspeckle::grin
