#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "grin/rays/marching/step_curve.h"
#include "grin/render/curved/ray_field.h"
#include "grin/render/stage/flight.h"
#include "grin/render/stage/part_medium.h"
#include "grin/render/stage/stage.h"
#include "grin/render/stage/straight_stage.h"

namespace flatspeckle::grin {

/// A stretch of a flight within one part.
struct FlightLeg {
  PathPoint start;
  Vec3 direction;  ///< there, unit
  double length;
  double weight;  ///< of the flight, there
};
using FlightLog = std::vector<FlightLeg>;

/// Calls use(x, arc length that x stands for times the light left there) for points of a leg that
/// are at most `apart` from each other, evenly spaced from a random start: sums over them are
/// integrals on average. x_at(s) is asked for increasing s.
template <class At, class Use>
void for_points(const FlightLeg& leg, const PartMedium& medium, double apart, RandomStream& random,
                At x_at, const Use& use) {
  const double count = std::max(1.0, std::ceil(leg.length / apart));
  const double spacing = leg.length / count, offset = random.uniform();
  const bool absorbs = !medium.scatters() && medium.mu_t() > 0;
  const auto collide = [&] { return sample_free_flight(medium.majorant(), random.uniform()); };
  double left = leg.weight;
  double tentative = absorbs && medium.grid() ? collide() : std::numeric_limits<double>::infinity();
  for (double i = 0; i < count; ++i) {
    const double s = (i + offset) * spacing;
    for (; tentative < s; tentative += collide()) left *= medium.lacking(x_at(tentative));
    const bool is_even = absorbs && !medium.grid();
    use(x_at(s), spacing * (is_even ? left * transmittance(medium.mu_t(), s) : left));
  }
}

/// Which flights tell |J|, about half of their cost where rays are curved; joins always do.
enum class Spreading { none, to_boundary, all };

struct SpaceOptions {
  double step = 1;  ///< of curved rays in sigma: length at index 1
  double max_length = std::numeric_limits<double>::infinity();  ///< arc length of a curved flight
                                                                ///< or join; longer ones are lost
  Spreading spreading = Spreading::all;
  bool leapfrogs = false;  ///< make_ray_field()
};

/// What the estimators ask of space. Rays are straight where the index is the same everywhere in a
/// part, and those of a RayField, by one virtual call for each leg, in the part that a field of
/// varying index fills.
class Space {
 public:
  /// The stage has passed check(): make_space() checks it.
  Space(const AnyIndexField& field, const Stage& stage, const SpaceOptions& options = {});

  double index(const PathPoint& p) const {
    return 1 + (is_curved(p.part) ? field_->excess(p.x) : setup_->stage.excess(p.part));
  }
  /// The index varies in some part.
  bool has_curves() const { return !setup_->is_straight; }
  bool is_curved(Part part) const { return part == setup_->field_part && has_curves(); }

  /// log: its legs are added to that. rise: the first leg, if straight, is stretched along it
  /// (StraightStage).
  Flight fly(const PathPoint& from, const Vec3& direction, RandomStream& random,
             FlightLog* log = nullptr, const Vec3* rise = nullptr) const {
    const Spreading spreading = setup_->options.spreading;
    if (spreading == Spreading::to_boundary && !log)
      return fly_again_to_boundary(from, direction, random, rise);
    return fly_once(from, direction, spreading != Spreading::none, random, log, rise);
  }
  /// Whether flights may go side by side, at less cost than one by one: in one part that the field
  /// fills, without |J|.
  bool has_lanes() const;
  /// Flights side by side. next(lane, flight) is told what became of the lane's last (null at
  /// first) and says where its next begins, if there is one; its random numbers are its own.
  struct FlightStart {
    PathPoint from;
    Vec3 direction;
    RandomStream* random;
  };
  using NextFlight = std::function<std::optional<FlightStart>(int lane, const Flight*)>;
  void fly_side_by_side(const NextFlight& next) const;
  /// Of a leg of a flight.
  template <class Use>
  void for_points(const FlightLeg& leg, double apart, RandomStream& random, const Use& use) const;

  /// Any, between points of these parts.
  bool can_join(const PathPoint& p, const PathPoint& q) const {
    return setup_->stage.are_alike(p.part, q.part) || joins_through();
  }
  double least_depth(const PathPoint& p, const PathPoint& q) const {
    return setup_->stage.least_depth(p, q);
  }
  /// A way that surfaces of bodies leave alone.
  std::optional<Join> join(const PathPoint& p, const PathPoint& q, RandomStream& random,
                           ConnectionStatistics& statistics) const;
  /// In flights, roughly.
  double cost_of_join() const { return field_->cost_of_curve(); }
  double cost_of_closed_join() const { return field_->cost_of_closed_curve(); }
  bool joins_through() const { return setup_->stage.refracts(); }
  /// One of the ways that are refracted or reflected there.
  std::optional<Join> join_through(const PathPoint& p, const PathPoint& q, RandomStream& random,
                                   ConnectionStatistics& statistics) const;

  /// Those of parallel light, backwards.
  std::vector<BeamWay> ways_to_beam(const PathPoint& p, const ParallelLight& light,
                                    std::span<const BeamSeed> seeds, RandomStream& random,
                                    ConnectionStatistics& statistics) const;
  /// The one that is refracted wherever it can be: always the same, if one is found.
  std::optional<BeamWay> plainest_way_to_beam(const PathPoint& p, const ParallelLight& light,
                                              RandomStream& random,
                                              ConnectionStatistics& statistics) const;
  /// What one random trial finds of them.
  std::optional<BeamWay> some_way_to_beam(const PathPoint& p, const ParallelLight& light,
                                          RandomStream& random,
                                          ConnectionStatistics& statistics) const;
  /// The one that starts so.
  std::optional<BeamWay> beam_way(const PathPoint& p, const ParallelLight& light,
                                  const Vec3& direction, const Passages& passages,
                                  RandomStream& random) const;

  /// The same space as light meets it at this phase of the sound, from 0 to 2 pi: S = cos(phase)
  /// of a standing wave (conventions, C28). Throws InputError for a field without sound.
  std::unique_ptr<const Space> frozen(double phase) const;

 private:
  /// What is the same at all phases.
  struct Setup {
    StraightStage stage;
    Part field_part;
    bool is_straight;
    std::vector<double> sides;  ///< of the surfaces of the field's room
    SpaceOptions options;
    double longest;                ///< arc length of a flight
    ConnectionOptions connection;  ///< by curves of the field
    ConnectionOptions search;      ///< of ways that are refracted, or to a beam
  };
  Space(std::shared_ptr<const Setup> setup, std::shared_ptr<const RayField> field)
      : setup_(std::move(setup)), field_(std::move(field)) {}

  /// As stage has it, but in the field of this phase.
  IndexGradient side(Part part, const Vec3& x) const {
    if (is_curved(part)) return field_->gradient(x);
    return {setup_->stage.excess(part), Vec3::Zero()};
  }
  /// That of the field.
  Room room() const { return setup_->stage.regions().room(setup_->field_part); }
  const PartMedium& medium() const { return setup_->stage.medium(setup_->field_part); }
  LegRoom leg_room() const { return {room(), medium(), setup_->options.step}; }
  /// The surface on which it ends, where the ray is then, to rounding.
  LegEnd end_on_surface(RayState& ray) const;

  friend class Legs;
  class Lanes;
  struct Neighbours;
  class Curve;

  bool searches_for_beams() const { return joins_through() || is_curved(around); }
  bool stays_inside(RayState ray, double sigma, int steps) const;
  Flight fly_once(const PathPoint& from, const Vec3& direction, bool spreads, RandomStream& random,
                  FlightLog* log, const Vec3* rise) const;
  Flight fly_again_to_boundary(const PathPoint& from, const Vec3& direction, RandomStream& random,
                               const Vec3* rise) const;
  void go_on(Flight& flight, std::optional<LegEnd> end, bool spreads, RandomStream& random,
             FlightLog* log) const;
  bool goes_outside(const Vec3& x, const Vec3& direction) const;
  void end_leg(Flight& flight, const RayState& ray, double weight) const;
  std::optional<LegEnd> leg(Flight& flight, Neighbours& neighbours, RandomStream& random) const;
  std::optional<LegEnd> curved_leg(Flight& flight, Neighbours& neighbours,
                                   RandomStream& random) const;
  void cross(Flight& flight, LegEnd surface, Neighbours& neighbours, RandomStream& random) const;
  double transmitted(const PathPoint& p, const Connection& curve, RandomStream& random) const;

  std::shared_ptr<const Setup> setup_;
  std::shared_ptr<const RayField> field_;
};

/// Points of a leg, one after the other.
class Space::Curve {
 public:
  Curve(const Space& space, const FlightLeg& leg)
      : field_(*space.field_),
        step_(space.setup_->options.step),
        now_(start_ray(field_, leg.start.x, leg.direction)),
        before_(now_) {}

  /// Increasing arc lengths.
  Vec3 operator()(double s) {
    while (now_.arc_length < s) {
      before_ = now_;
      field_.advance(step_, 1, now_, nullptr);
      if (!(now_.arc_length > before_.arc_length)) return before_.x;
    }
    const StepCurve curve(before_, now_, step_);
    return curve.x(curve.theta_at(s));
  }

 private:
  const RayField& field_;
  double step_;
  RayState now_, before_;
};

template <class Use>
void Space::for_points(const FlightLeg& leg, double apart, RandomStream& random,
                       const Use& use) const {
  const PartMedium& in = setup_->stage.medium(leg.start.part);
  if (is_curved(leg.start.part))
    return grin::for_points(leg, in, apart, random, Curve(*this, leg), use);
  const auto x_at = [&](double s) -> Vec3 { return leg.start.x + s * leg.direction; };
  grin::for_points(leg, in, apart, random, x_at, use);
}

/// Throws InputError for a bad stage.
std::unique_ptr<const Space> make_space(const AnyIndexField& field, const Stage& stage,
                                        const SpaceOptions& options = {});

}  // namespace flatspeckle::grin
