#include "grin/render/curved/ray_field.h"

#include <optional>
#include <tuple>

#include "grin/rays/connections/connection_solver.h"
#include "grin/rays/marching/step_curve.h"
#include "grin/rays/surfaces/first_crossing.h"

namespace flatspeckle::grin {

namespace {

/// The part of a flight that lies in an index field, in a room: equal steps, and a shorter
/// one at the end. As trace() it does not ask for the distance from the surface where that
/// is far away; places within a step are found on its StepCurve.
class CurvedLeg {
 public:
  CurvedLeg(const RayField& field, const LegRoom& room)
      : field_(field),
        room_(room.room),
        medium_(room.medium),
        step_(room.step),
        tolerance_(1e-9 * step_) {}

  /// Goes on from a state in the room, or on its surface and on the way in, at arc length 0.
  /// weight: of light that is absorbed and not scattered, is multiplied by an estimate of what is
  /// left. Tangent: nothing or a RayTangent, which becomes that of a fixed last step.
  template <class... Tangent>
  LegStop go(double longest, double& weight, RandomStream& random, RayState& ray,
             Tangent&... tangent) const {
    constexpr int most_steps = 1 << 20;
    LegProgress progress{next_collision(0, random), weight};
    const LegStop stop = go_on(longest, most_steps, progress, random, ray, tangent...);
    weight = progress.weight;
    return stop == LegStop::steps ? LegStop::lost : stop;
  }

  /// The same from any state of a leg, no more than so many steps.
  template <class... Tangent>
  LegStop go_on(double longest, int most_steps, LegProgress& progress, RandomStream& random,
                RayState& ray, Tangent&... tangent) const {
    const double outside = room_.distance(ray.x);
    const double put_back = outside >= -tolerance_ ? std::max(0.0, outside) + 0.75 * tolerance_ : 0;
    double clearance = put_back - outside;
    auto& [collision, weight] = progress;
    for (int steps = 0; ray.arc_length <= longest; ++steps) {
      if (steps == most_steps) return LegStop::steps;
      const std::tuple<RayState, Tangent...> before(ray, tangent...);
      const RayState& start = std::get<0>(before);
      field_.step(ray, tangent..., step_);
      const bool is_lost = !(ray.arc_length > start.arc_length);
      const double arc = is_lost ? 3 * start.v.norm() * step_  // more than it might have been
                                 : 1.1 * (ray.arc_length - start.arc_length);
      clearance -= arc;
      std::optional<double> exit;
      PartOfStep tried;
      if (is_lost || !(clearance > 0)) {
        clearance = put_back - room_.distance(ray.x);
        const double before_step = put_back - room_.distance(start.x);
        if (is_lost || !(clearance > 0 && clearance + before_step > arc))
          exit = way_out(start, ray, put_back, arc, is_lost, tried);
        if (!exit && is_lost) return LegStop::lost;
      }
      const auto go_only = [&](double part) {
        if (sizeof...(tangent) == 0 && part == tried.theta) {
          ray = tried.end;
          return;
        }
        std::tie(ray, tangent...) = before;
        field_.step(ray, tangent..., part * step_);
      };
      if (exit) go_only(*exit);
      const double part = exit.value_or(1);
      if (collision <= ray.arc_length) {
        if (const auto at = collide({start, ray, part * step_}, collision, weight, random)) {
          go_only(*at * part);
          return LegStop::collision;
        }
      }
      if (exit)
        return put_back - room_.distance(ray.x) <= tolerance_ ? LegStop::surface : LegStop::lost;
    }
    return LegStop::lost;
  }

  /// Estimates the transmittance of a curve of so many equal steps by ratio tracking.
  double ratio_tracked(RayState ray, double sigma, int steps, RandomStream& random) const {
    double left = 1, collision = next_collision(0, random);
    for (int i = 0; i < steps && left > 0; ++i) {
      const RayState start = ray;
      field_.step(ray, sigma / steps);
      const StepCurve curve(start, ray, sigma / steps);
      for (; collision < ray.arc_length; collision = next_collision(collision, random))
        left *= medium_.lacking(curve.x(curve.theta_at(collision)));
    }
    return left;
  }

  /// The same of so long an arc.
  double ratio_tracked(RayState ray, double arc_length, RandomStream& random) const {
    const double end = ray.arc_length + arc_length;
    double left = 1, collision = next_collision(ray.arc_length, random);
    while (left > 0 && collision < end) {
      const RayState start = ray;
      field_.step(ray, step_);
      if (!(ray.arc_length > start.arc_length)) return 0;
      const StepCurve curve(start, ray, step_);
      for (; collision < std::min(ray.arc_length, end);
           collision = next_collision(collision, random))
        left *= medium_.lacking(curve.x(curve.theta_at(collision)));
    }
    return left;
  }

 private:
  double next_collision(double after, RandomStream& random) const {
    return grin::next_collision(medium_, after, random);
  }
  /// Where in a step light collides, theta; goes on to the first tentative collision beyond it.
  std::optional<double> collide(const StepCurve& curve, double& collision, double& weight,
                                RandomStream& random) const {
    for (; collision <= curve.end_arc_length(); collision = next_collision(collision, random)) {
      const double theta = curve.theta_at(collision);
      if (medium_.collides(curve.x(theta), weight, random)) return theta;
    }
    return std::nullopt;
  }

  struct PartOfStep {
    double theta = -1;
    RayState end = {};
  };
  /// The part of a step that ends on the surface, within the last quarter of the tolerance before
  /// it; nothing where the step does not reach it. tried: the last that was looked at.
  std::optional<double> way_out(const RayState& start, const RayState& end, double put_back,
                                double arc, bool is_lost, PartOfStep& tried) const {
    const auto exact = [&](double theta) {
      tried = {theta, start};
      field_.step(tried.end, theta * step_);
      return put_back - room_.distance(tried.end.x);
    };
    if (is_lost) return search(exact, arc);
    const StepCurve curve(start, end, step_);
    const auto close = [&](double theta) { return put_back - room_.distance(curve.x(theta)); };
    const auto guess = is_like_chord(start, end) ? once(close) : search(close, arc);
    if (!guess) return std::nullopt;
    const auto mended = mend(exact, *guess, close);
    return mended ? mended : search(exact, arc);
  }

  template <class Function>
  std::optional<double> search(const Function& clearance, double arc) const {
    const auto bracket = first_change(clearance, {0, 1, clearance(0), clearance(1)}, arc);
    if (!bracket) return std::nullopt;
    return zero(clearance, *bracket, tolerance_ / 4);
  }

  /// In a convex room such a step leaves once, if its end is outside.
  bool is_like_chord(const RayState& start, const RayState& end) const {
    constexpr double turned = 0.1;  // rad
    return room_.is_convex() && (end.v - start.v).squaredNorm() < turned * turned;
  }
  template <class Function>
  std::optional<double> once(const Function& clearance) const {
    const Bracket step{0, 1, clearance(0), clearance(1)};
    if (step.fb > 0) return std::nullopt;
    return zero(clearance, step, tolerance_ / 4);
  }

  /// Newton steps with the slope of the close curve.
  template <class Exact, class Close>
  std::optional<double> mend(const Exact& exact, double theta, const Close& close) const {
    const double aim = tolerance_ / 8, apart = 1e-3;
    const double slope = (close(theta + apart) - close(theta - apart)) / (2 * apart);
    for (int i = 0; i < 4; ++i) {
      const double off = exact(theta) - aim;
      if (std::abs(off) < aim) return theta;
      theta -= off / slope;
      if (!(theta > 0 && theta <= 1.01)) return std::nullopt;
    }
    return std::nullopt;
  }

  const RayField& field_;
  const Room room_;
  const PartMedium& medium_;
  double step_, tolerance_;
};

/// Integrators of a RayField for ConnectionTrial.
struct Leap {
  static void step(const RayField& field, RayState& ray, double h) { field.leap(ray, h); }
  static void step(const RayField& field, RayState& ray, RayTangent& tangent, double h) {
    field.leap(ray, tangent, h);
  }
};
struct OwnStep {
  using Rough = Leap;
  static bool is_rough(const RayField& field) { return field.leapfrogs(); }
  static void step(const RayField& field, RayState& ray, double h) { field.step(ray, h); }
  static void step(const RayField& field, RayState& ray, RayTangent& tangent, double h) {
    field.step(ray, tangent, h);
  }
};

using Trial = ConnectionTrial<RayField, Sides, OwnStep>;

}  // namespace

LegStop RayField::fly(const LegRoom& room, double longest, double& weight, RandomStream& random,
                      RayState& ray, RayTangent* tangent) const {
  const CurvedLeg leg(*this, room);
  return tangent ? leg.go(longest, weight, random, ray, *tangent)
                 : leg.go(longest, weight, random, ray);
}
LegStop RayField::go_on(const LegRoom& room, double longest, int most_steps, LegProgress& progress,
                        RandomStream& random, RayState& ray) const {
  return CurvedLeg(*this, room).go_on(longest, most_steps, progress, random, ray);
}
double RayField::ratio_tracked(const LegRoom& room, const RayState& ray, double sigma, int steps,
                               RandomStream& random) const {
  return CurvedLeg(*this, room).ratio_tracked(ray, sigma, steps, random);
}
double RayField::ratio_tracked(const LegRoom& room, const RayState& ray, double arc_length,
                               RandomStream& random) const {
  return CurvedLeg(*this, room).ratio_tracked(ray, arc_length, random);
}

ConnectionEstimate RayField::connect(const CurveEnds& ends, const ConnectionOptions& options,
                                     RandomStream& random, ConnectionStatistics& statistics) const {
  const Trial trial(*this, ends.region, ends.from, ends.to, options);
  return connect_chord_first(trial, random, statistics);
}
std::vector<FoundConnection> RayField::connections(const CurveEnds& ends,
                                                   const ConnectionOptions& options,
                                                   std::uint64_t trials, RandomStream& random,
                                                   ConnectionStatistics& statistics) const {
  const Trial trial(*this, ends.region, ends.from, ends.to, options);
  return all_connections(trial, trials, random, statistics);
}

}  // namespace flatspeckle::grin
