#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "grin/media/geometry/vec3.h"
#include "grin/render/curved/ray_field_of.h"

namespace flatspeckle::grin {

/// A ray of Luneburg's ball in closed form (conventions, C27), lengths in radii from its centre: an
/// ellipse about that, x = x0 cos t + v0 sin t, t = sigma. On it r^2 = 1 - p cos u and n^2 = 1 + p
/// cos u, where u = u0 + 2 t; inside the ball |u| <= pi/2, so that no way there is longer than t =
/// pi/2.
class LuneburgOrbit {
 public:
  /// |v|^2 = 2 - r^2 here.
  LuneburgOrbit(const Vec3& x, const Vec3& v) : inside_(1 - x.squaredNorm()), outwards_(x.dot(v)) {}

  /// Where the ray leaves a sphere about the centre: t, below 0 for a ray on its way out beyond it.
  double way_out(double radius) const {
    const double cosine = (1 - radius * radius) / swing();
    return (std::acos(std::min(cosine, 1.0)) - std::atan2(outwards_, inside_)) / 2;
  }

  /// On the way ahead, where it is `now` here.
  double largest_index(double now) const { return outwards_ > 0 ? now : std::sqrt(1 + swing()); }

  /// Between t = 0 and pi/2, of which sine and cosine are.
  double squared_index(double cosine, double sine) const {
    return 1 + inside_ * (cosine * cosine - sine * sine) - outwards_ * 2 * sine * cosine;
  }

  /// Of the first t, as above: integrals of n dt, by Gauss's eight points (to 1e-9), and n^2 dt.
  double arc_length(double t, double cosine, double sine) const {
    const double in = inside_ * cosine - outwards_ * sine,
                 out = outwards_ * cosine + inside_ * sine;
    return arc_about(t, in, out);
  }
  double optical_path(double t, double cosine, double sine) const {
    return t + sine * (inside_ * cosine - outwards_ * sine);
  }

  /// Of so long a way, p cos u and p sin u at its middle.
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
  /// To rounding up to pi/2: series, as loops of calls do not become vectors.
  static CosSin cos_sin(double x) {
    const double y = x * x;
    double cosine = 1, sine = 1;
    for (int k = 20; k > 0; k -= 2) {
      cosine = 1 - y * (1.0 / (k * (k - 1))) * cosine;
      sine = 1 - y * (1.0 / (k * (k + 1))) * sine;
    }
    return {cosine, x * sine};
  }

  double swing() const { return std::sqrt(inside_ * inside_ + outwards_ * outwards_); }  ///< p

  double inside_, outwards_;  ///< p cos u, p sin u at t = 0
};

/// The one way between two points of the ball, from x0 to x1 (apart) and as long as t, seen from
/// its middle: with t' = t/2, m = (x0 + x1)/2 = x cos t' and e = (x1 - x0)/2 = v sin t', r^2 + v^2
/// = 2 there is an equation for sin^2 t', whose smaller root is the way inside.
struct LuneburgWay {
  double half_cosine, half_sine;
  Vec3 x, v;  ///< at the middle

  LuneburgWay(const Vec3& x0, const Vec3& x1) {
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
    const Vec3 from = in_units(ends.from), to = in_units(ends.to);
    const LuneburgWay way(from, to);
    const Vec3 start = way.start(), last = way.end();
    const double n = start.norm(), n_last = last.norm(), aligned = start.dot(last);
    const double arc = unit_ * way.arc_length(), across = unit_ * way.sine();
    const double spreading = across * across * aligned * n / n_last;
    const TrialOutcome outcome = !(std::abs(spreading) > 0) ? TrialOutcome::degenerate
                                 : arc > options.max_length ? TrialOutcome::too_long
                                                            : TrialOutcome::converged;
    statistics.add_pair(outcome);
    if (outcome != TrialOutcome::converged) return {outcome, std::nullopt, 0};
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
