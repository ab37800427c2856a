#pragma once

#include <numbers>

#include "grin/render/curved/luneburg_orbit.h"
#include "grin/render/curved/ray_field_of.h"

namespace flatspeckle::grin {

/// Rays of a Luneburg ball that end on a sphere about its centre, within its rim: closed forms
/// instead of steps, and one curve between any two points.
class LuneburgRays final : public RayFieldOf<Luneburg> {
 public:
  /// radius: of the sphere.
  LuneburgRays(const Luneburg& field, double radius)
      : RayFieldOf(field),
        centre_(field.centre()),
        unit_(field.profile().radius),
        radius_(radius / unit_) {}

  bool has_lanes() const override { return false; }
  LegStop fly(const LegRoom& room, double longest, double& weight, RandomStream& random,
              RayState& ray, RayTangent* tangent) const override {
    if (room.medium.grid()) return RayFieldOf::fly(room, longest, weight, random, ray, tangent);
    const double end = radius_ - 1e-9 / 8 * room.step / unit_;
    const LuneburgOrbit orbit(in_units(ray.x), ray.v);
    const auto collision =
        room.medium.scatters() ? collide(orbit, ray, end, room.medium, random) : std::nullopt;
    move(orbit, collision ? *collision : Turn(std::max(orbit.way_out(end), 0.0)), ray, tangent);
    if (!(ray.arc_length <= longest)) return LegStop::lost;
    return collision ? LegStop::collision : LegStop::surface;
  }

  void advance(double sigma, int /*steps*/, RayState& ray, RayTangent* tangent) const override {
    const double t = sigma / unit_;
    const int parts = static_cast<int>(std::ceil(std::abs(t) / longest_way));
    for (int i = 0; i < parts; ++i)
      move(LuneburgOrbit(in_units(ray.x), ray.v), Turn(t / parts), ray, tangent);
  }

  double cost_of_curve() const override { return 0.5; }
  double cost_of_closed_curve() const override { return 2.5; }
  ConnectionEstimate connect(const CurveEnds& ends, const ConnectionOptions& options,
                             RandomStream& /*random*/,
                             ConnectionStatistics& statistics) const override {
    ++statistics.pairs;
    const Vec3 from = in_units(ends.from), to = in_units(ends.to);
    const LuneburgWay way(from, to);
    const Vec3 start = way.start(), last = way.end();
    const double n = start.norm(), n_last = last.norm(), aligned = start.dot(last);
    const double arc = unit_ * way.arc_length(), across = unit_ * way.sine();
    const double spreading = across * across * aligned * n / n_last;
    const TrialOutcome outcome = !(std::abs(spreading) > 0) ? TrialOutcome::degenerate
                                 : arc > options.max_length ? TrialOutcome::too_long
                                                            : TrialOutcome::converged;
    ++statistics.outcomes[static_cast<int>(outcome)];
    if (outcome != TrialOutcome::converged) return {outcome, std::nullopt, 0};
    ++statistics.found;
    const double sigma = unit_ * way.t();
    return {outcome,
            Connection{start / n, last / n_last, sigma, arc, unit_ * way.optical_path(),
                       std::abs(spreading), spreading < 0 ? -1 : 1,
                       static_cast<int>(std::ceil(sigma / options.step))},
            1};
  }

 private:
  static constexpr double longest_way = std::numbers::pi / 2;

  Vec3 in_units(const Vec3& x) const { return (x - centre_) / unit_; }

  struct Turn {
    double t, cosine, sine;
    explicit Turn(double by) : t(by), cosine(std::cos(by)), sine(std::sin(by)) {}
  };

  /// The first collision inside: tentative ones where the index is largest, of which as
  /// many as it is lower are none.
  std::optional<Turn> collide(const LuneburgOrbit& orbit, const RayState& ray, double end,
                              const PartMedium& medium, RandomStream& random) const {
    const double largest = orbit.largest_index(ray.v.norm()), lowest = 2 - end * end;
    for (double t = 0;;) {
      t += sample_free_flight(medium.majorant() * unit_ * largest, random.uniform());
      if (!(t < longest_way)) return std::nullopt;
      const Turn turn(t);
      const double square = orbit.squared_index(turn.cosine, turn.sine);
      if (!(square > lowest)) return std::nullopt;
      if (random.uniform() * largest < std::sqrt(square)) return turn;
    }
  }

  void move(const LuneburgOrbit& orbit, const Turn& turn, RayState& ray,
            RayTangent* tangent) const {
    const auto [t, cosine, sine] = turn;
    ray.arc_length += unit_ * orbit.arc_length(t, cosine, sine);
    ray.optical_path += unit_ * orbit.optical_path(t, cosine, sine);
    const Vec3 x = ray.x - centre_;
    ray.x = centre_ + cosine * x + unit_ * sine * ray.v;
    ray.v = cosine * ray.v - sine / unit_ * x;
    if (!tangent) return;
    const Mat3 dx = tangent->dx;
    tangent->dx = cosine * dx + unit_ * sine * tangent->dv;
    tangent->dv = cosine * tangent->dv - sine / unit_ * dx;
  }

  Vec3 centre_;
  double unit_, radius_;
};

/// Nothing where there is no closed form.
inline std::unique_ptr<const RayField> closed_form_within(const Luneburg& field,
                                                          const Sphere& end) {
  const double radius = field.profile().radius, rounding = 1e-12 * radius;
  const bool fits =
      (end.centre - field.centre()).norm() <= rounding && end.radius <= radius + rounding;
  return fits ? std::make_unique<LuneburgRays>(field, end.radius) : nullptr;
}

}  // namespace flatspeckle::grin
