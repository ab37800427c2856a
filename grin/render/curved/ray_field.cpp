#include "grin/render/curved/ray_field.h"

#include <optional>
#include <tuple>

#include "grin/rays/connections/connection_solver.h"
#include "grin/rays/marching/step_curve.h"
#include "grin/rays/surfaces/first_crossing.h"

namespace flatspeckle::grin {

namespace {

/// Traces one segment of a flight through an index field up to the surface of a region, by equal
/// steps and a shorter last one. Like trace(), it does not compute the distance to the surface as
/// long as the surface is certainly far away. Positions within a step are interpolated by
/// StepCurve.
class CurvedSegment {
 public:
  CurvedSegment(const RayField& field, const SegmentDomain& domain)
      : field_(field),
        region_(domain.region),
        medium_(domain.medium),
        step_(domain.step),
        tolerance_(1e-9 * step_) {}

  /// Traces the segment from a state of arc length 0, which is in the region, or on its surface
  /// with the direction inwards. weight: is multiplied by an estimate of the transmittance if the
  /// medium absorbs without scattering. tangent: none, or a RayTangent; its derivatives are those
  /// at a fixed length of the last step, although neighbouring rays meet the surface after
  /// different lengths.
  template <class... Tangent>
  SegmentStop go(double longest, double& weight, RandomStream& random, RayState& ray,
                 Tangent&... tangent) const {
    constexpr int most_steps = 1 << 20;
    SegmentProgress progress{next_collision(0, random), weight};
    const SegmentStop stop = go_on(longest, most_steps, progress, random, ray, tangent...);
    weight = progress.weight;
    return stop == SegmentStop::steps ? SegmentStop::lost : stop;
  }

  /// Continues the segment from any state on it, for at most most_steps steps.
  template <class... Tangent>
  SegmentStop go_on(double longest, int most_steps, SegmentProgress& progress, RandomStream& random,
                    RayState& ray, Tangent&... tangent) const {
    const double outside = region_.distance(ray.x);
    const double put_back = outside >= -tolerance_ ? std::max(0.0, outside) + 0.75 * tolerance_ : 0;
    double clearance = put_back - outside;
    auto& [collision, weight] = progress;
    for (int steps = 0; ray.arc_length <= longest; ++steps) {
      if (steps == most_steps) return SegmentStop::steps;
      const std::tuple<RayState, Tangent...> before(ray, tangent...);
      const RayState& start = std::get<0>(before);
      field_.step(ray, tangent..., step_);
      const bool is_lost = !(ray.arc_length > start.arc_length);
      const double arc =
          is_lost ? 3 * start.v.norm() * step_  // upper bound of the arc length of the step
                  : 1.1 * (ray.arc_length - start.arc_length);
      clearance -= arc;
      std::optional<double> exit;
      PartOfStep tried;
      if (is_lost || !(clearance > 0)) {
        clearance = put_back - region_.distance(ray.x);
        const double before_step = put_back - region_.distance(start.x);
        if (is_lost || !(clearance > 0 && clearance + before_step > arc))
          exit = exit_distance(start, ray, put_back, arc, is_lost, tried);
        if (!exit && is_lost) return SegmentStop::lost;
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
          return SegmentStop::collision;
        }
      }
      if (exit)
        return put_back - region_.distance(ray.x) <= tolerance_ ? SegmentStop::surface
                                                                : SegmentStop::lost;
    }
    return SegmentStop::lost;
  }

  /// Estimates, by ratio tracking, the transmittance along the curve of length sigma that starts at
  /// `ray` and is traced in equal steps.
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

  /// Estimates, by ratio tracking, the transmittance along the arc of this length that starts at
  /// `ray`.
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
  /// Returns the fraction theta of a step at which a real collision occurs. If there is none,
  /// returns nullopt and advances `collision`, the arc length of the next tentative collision,
  /// beyond the step.
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
  /// Returns the fraction of the step after which the ray reaches the surface: it is then before
  /// the surface by less than a quarter of the tolerance. Returns nullopt if the step does not
  /// reach the surface. tried: receives the last fraction for which the state was computed.
  std::optional<double> exit_distance(const RayState& start, const RayState& end, double put_back,
                                      double arc, bool is_lost, PartOfStep& tried) const {
    const auto exact = [&](double theta) {
      tried = {theta, start};
      field_.step(tried.end, theta * step_);
      return put_back - region_.distance(tried.end.x);
    };
    if (is_lost) return search(exact, arc);
    const StepCurve curve(start, end, step_);
    const auto close = [&](double theta) { return put_back - region_.distance(curve.x(theta)); };
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

  /// Whether a step leaves the region at most once: a nearly straight step in a convex region.
  bool is_like_chord(const RayState& start, const RayState& end) const {
    constexpr double turned = 0.1;  // rad
    return region_.is_convex() && (end.v - start.v).squaredNorm() < turned * turned;
  }
  template <class Function>
  std::optional<double> once(const Function& clearance) const {
    const Bracket step{0, 1, clearance(0), clearance(1)};
    if (step.fb > 0) return std::nullopt;
    return zero(clearance, step, tolerance_ / 4);
  }

  /// Improves theta, the fraction of a step at which the ray reaches the surface, by Newton steps
  /// with positions of the exact ray and the derivative of the interpolated curve. Returns nullopt
  /// if they do not converge.
  template <class Exact, class Close>
  std::optional<double> mend(const Exact& exact, double theta, const Close& close) const {
    const double aim = tolerance_ / 8, apart = 1e-3;
    const double derivative = (close(theta + apart) - close(theta - apart)) / (2 * apart);
    for (int i = 0; i < 4; ++i) {
      const double off = exact(theta) - aim;
      if (std::abs(off) < aim) return theta;
      theta -= off / derivative;
      if (!(theta > 0 && theta <= 1.01)) return std::nullopt;
    }
    return std::nullopt;
  }

  const RayField& field_;
  const SurfaceRegion region_;
  const PartMedium& medium_;
  double step_, tolerance_;
};

/// Integrators with which ConnectionTrial traces rays of a RayField: Leap is Leapfrog, OwnStep is
/// the integrator that suits the field.
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

SegmentStop RayField::fly(const SegmentDomain& domain, double longest, double& weight,
                          RandomStream& random, RayState& ray, RayTangent* tangent) const {
  const CurvedSegment segment(*this, domain);
  return tangent ? segment.go(longest, weight, random, ray, *tangent)
                 : segment.go(longest, weight, random, ray);
}
SegmentStop RayField::go_on(const SegmentDomain& domain, double longest, int most_steps,
                            SegmentProgress& progress, RandomStream& random, RayState& ray) const {
  return CurvedSegment(*this, domain).go_on(longest, most_steps, progress, random, ray);
}
double RayField::ratio_tracked(const SegmentDomain& domain, const RayState& ray, double sigma,
                               int steps, RandomStream& random) const {
  return CurvedSegment(*this, domain).ratio_tracked(ray, sigma, steps, random);
}
double RayField::ratio_tracked(const SegmentDomain& domain, const RayState& ray, double arc_length,
                               RandomStream& random) const {
  return CurvedSegment(*this, domain).ratio_tracked(ray, arc_length, random);
}

ConnectionEstimate RayField::connect(const CurveEndpoints& ends, const ConnectionOptions& options,
                                     RandomStream& random, ConnectionStatistics& statistics) const {
  const Trial trial(*this, ends.region, ends.from, ends.to, options);
  return connect_chord_first(trial, random, statistics);
}
std::vector<FoundConnection> RayField::connections(const CurveEndpoints& ends,
                                                   const ConnectionOptions& options,
                                                   std::uint64_t trials, RandomStream& random,
                                                   ConnectionStatistics& statistics) const {
  const Trial trial(*this, ends.region, ends.from, ends.to, options);
  return all_connections(trial, trials, random, statistics);
}

}  // namespace flatspeckle::grin
