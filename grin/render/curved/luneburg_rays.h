#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "grin/media/geometry/vec3.h"
#include "grin/render/curved/ray_field_of.h"

namespace flatspeckle::grin {

/// A ray of Luneburg's ball in closed form (conventions, C27). Lengths are in units of the ball's
/// radius, and positions are relative to its centre. The ray is an ellipse about the centre,
///   x = x0 cos t + v0 sin t,  t = sigma.
/// Along it r^2 = 1 - p cos u and n^2 = 1 + p cos u, where u = u0 + 2 t, and p and u0 are constants
/// of the ray. Inside the ball |u| <= pi/2, so that t <= pi/2 for any ray inside.
class LuneburgOrbit {
 public:
  /// Requires |v|^2 = 2 - r^2.
  LuneburgOrbit(const Vec3& x, const Vec3& v) : inside_(1 - x.squaredNorm()), outwards_(x.dot(v)) {}

  /// Returns t at which the ray leaves the sphere of this radius about the centre; negative for an
  /// outgoing ray that starts beyond the sphere.
  double exit_distance(double radius) const {
    const double cosine = (1 - radius * radius) / swing();
    return (std::acos(std::min(cosine, 1.0)) - std::atan2(outwards_, inside_)) / 2;
  }

  /// Largest index on the ray ahead; `now` is the index at its start.
  double largest_index(double now) const { return outwards_ > 0 ? now : std::sqrt(1 + swing()); }

  /// Returns n^2 at t in (0, pi/2), given cosine and sine of t.
  double squared_index(double cosine, double sine) const {
    return 1 + inside_ * (cosine * cosine - sine * sine) - outwards_ * 2 * sine * cosine;
  }

  /// arc_length() returns the integral of n dt from 0 to t, by Gauss quadrature with eight points,
  /// accurate to 1e-9; optical_path() returns that of n^2 dt. cosine, sine: of t.
  double arc_length(double t, double cosine, double sine) const {
    const double in = inside_ * cosine - outwards_ * sine,
                 out = outwards_ * cosine + inside_ * sine;
    return arc_about(t, in, out);
  }
  double optical_path(double t, double cosine, double sine) const {
    return t + sine * (inside_ * cosine - outwards_ * sine);
  }

  /// Returns the arc length of a curve over an interval t of sigma. in, out: p cos u and p sin u at
  /// the middle of the curve.
  static double arc_about(double t, double in, double out) {
    double sum = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto [cosine, sine] = cos_sin(t * nodes[i]);
      const double even = 1 + in * cosine, odd = out * sine;
      sum += weights[i] *
             (std::sqrt(std::max(even - odd, 0.0)) + std::sqrt(std::max(even + odd, 0.0)));
    }
    return t / 2 * sum;
  }

 private:
  static constexpr std::array nodes{0.18343464249564980494, 0.52553240991632898582,
                                    0.79666647741362673959, 0.96028985649753623168};
  static constexpr std::array weights{0.36268378337836198297, 0.31370664587788728734,
                                      0.22238103445337447054, 0.10122853629037625915};
  struct CosSin {
    double cosine, sine;
  };
  /// Returns cosine and sine of x up to pi/2, accurate to rounding, by power series. Unlike library
  /// calls, these can be vectorised.
  static CosSin cos_sin(double x) {
    const double y = x * x;
    double cosine = 1, sine = 1;
    for (int k = 20; k > 0; k -= 2) {
      cosine = 1 - y * (1.0 / (k * (k - 1))) * cosine;
      sine = 1 - y * (1.0 / (k * (k + 1))) * sine;
    }
    return {cosine, x * sine};
  }

  /// Returns p, the constant of the ray in r^2 = 1 - p cos u.
  double swing() const { return std::sqrt(inside_ * inside_ + outwards_ * outwards_); }

  double inside_, outwards_;  ///< p cos u0 and p sin u0 (class comment)
};

/// The unique curve between two distinct points x0 and x1 of the ball, over an interval t of sigma.
/// It is parametrised by its state x, v at the middle: with t' = t/2, m = (x0 + x1)/2 = x cos t'
/// and e = (x1 - x0)/2 = v sin t'. The condition |x|^2 + |v|^2 = 2 gives a quadratic equation for
/// sin^2 t', whose smaller root is the curve inside the ball.
struct LuneburgCurve {
  double half_cosine, half_sine;
  Vec3 x, v;  ///< position and momentum (n times direction) at the middle of the curve

  LuneburgCurve(const Vec3& x0, const Vec3& x1) {
    const Vec3 m = (x0 + x1) / 2, e = (x1 - x0) / 2;
    const double ee = e.squaredNorm(), b = 2 + ee - m.squaredNorm();
    const double square = 2 * ee / (b + std::sqrt(std::max(b * b - 8 * ee, 0.0)));
    half_sine = std::sqrt(square);
    half_cosine = std::sqrt(1 - square);
    x = m / half_cosine;
    v = e / half_sine;
  }

  Vec3 start() const { return half_cosine * v + half_sine * x; }
  Vec3 end() const { return half_cosine * v - half_sine * x; }
  double sine() const { return 2 * half_sine * half_cosine; }
  double t() const { return 2 * std::asin(half_sine); }
  double arc_length() const { return LuneburgOrbit::arc_about(t(), 1 - x.squaredNorm(), x.dot(v)); }
  double optical_path() const { return t() + sine() * (1 - x.squaredNorm()); }
};

/// Rays of a Luneburg ball inside a sphere about its centre that does not extend beyond the ball,
/// computed in closed form instead of by numerical steps. Exactly one curve connects two points.
class LuneburgRays final : public RayFieldOf<Luneburg> {
 public:
  /// radius: radius of the sphere on which rays end.
  LuneburgRays(const Luneburg& field, double radius)
      : RayFieldOf(field),
        centre_(field.centre()),
        unit_(field.profile().radius),
        radius_(radius / unit_) {}

  bool has_lanes() const override { return false; }
  SegmentStop fly(const SegmentDomain& domain, double longest, double& weight, RandomStream& random,
                  RayState& ray, RayTangent* tangent) const override {
    if (domain.medium.varies())
      return RayFieldOf::fly(domain, longest, weight, random, ray, tangent);
    const double end = radius_ - 1e-9 / 8 * domain.step / unit_;
    const LuneburgOrbit orbit(in_units(ray.x), ray.v);
    const auto collision =
        domain.medium.scatters() ? collide(orbit, ray, end, domain.medium, random) : std::nullopt;
    move(orbit, collision ? *collision : Turn(std::max(orbit.exit_distance(end), 0.0)), ray,
         tangent);
    if (!(ray.arc_length <= longest)) return SegmentStop::lost;
    return collision ? SegmentStop::collision : SegmentStop::surface;
  }

  void advance(double sigma, int /*steps*/, RayState& ray, RayTangent* tangent) const override {
    const double t = sigma / unit_;
    const int parts = static_cast<int>(std::ceil(std::abs(t) / longest_distance));
    for (int i = 0; i < parts; ++i)
      move(LuneburgOrbit(in_units(ray.x), ray.v), Turn(t / parts), ray, tangent);
  }

  double cost_of_curve() const override { return 0.5; }
  double cost_of_closed_curve() const override { return 2.5; }
  ConnectionEstimate connect(const CurveEndpoints& ends, const ConnectionOptions& options,
                             RandomStream& /*random*/,
                             ConnectionStatistics& statistics) const override {
    const Vec3 from = in_units(ends.from), to = in_units(ends.to);
    const LuneburgCurve curve(from, to);
    const Vec3 start = curve.start(), last = curve.end();
    const double n = start.norm(), n_last = last.norm(), aligned = start.dot(last);
    const double arc = unit_ * curve.arc_length(), across = unit_ * curve.sine();
    const double spreading = across * across * aligned * n / n_last;
    const TrialOutcome outcome = !(std::abs(spreading) > 0) ? TrialOutcome::degenerate
                                 : arc > options.max_length ? TrialOutcome::too_long
                                                            : TrialOutcome::converged;
    statistics.add_pair(outcome);
    if (outcome != TrialOutcome::converged) return {outcome, std::nullopt, 0};
    const double sigma = unit_ * curve.t();
    return {outcome,
            Connection{start / n, last / n_last, sigma, arc, unit_ * curve.optical_path(),
                       std::abs(spreading), spreading < 0 ? -1 : 1,
                       static_cast<int>(std::ceil(sigma / options.step))},
            1};
  }

 private:
  static constexpr double longest_distance = std::numbers::pi / 2;

  Vec3 in_units(const Vec3& x) const { return (x - centre_) / unit_; }

  struct Turn {
    double t, cosine, sine;
    explicit Turn(double by) : t(by), cosine(std::cos(by)), sine(std::sin(by)) {}
  };

  /// Samples t of the first collision; nullopt if the ray leaves the sphere before. Tentative
  /// collisions occur at the rate for the largest index on the ray, and are accepted with
  /// probability local index / largest index.
  std::optional<Turn> collide(const LuneburgOrbit& orbit, const RayState& ray, double end,
                              const PartMedium& medium, RandomStream& random) const {
    const double largest = orbit.largest_index(ray.v.norm()), lowest = 2 - end * end;
    for (double t = 0;;) {
      t += sample_free_flight(medium.majorant() * unit_ * largest, random.uniform());
      if (!(t < longest_distance)) return std::nullopt;
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

/// Returns closed-form rays that end on the sphere `end`; null if it is not about the ball's centre
/// or extends beyond the ball.
inline std::unique_ptr<const RayField> closed_form_within(const Luneburg& field,
                                                          const Sphere& end) {
  const double radius = field.profile().radius, rounding = 1e-12 * radius;
  const bool fits =
      (end.centre - field.centre()).norm() <= rounding && end.radius <= radius + rounding;
  return fits ? std::make_unique<LuneburgRays>(field, end.radius) : nullptr;
}

}  // namespace flatspeckle::grin
