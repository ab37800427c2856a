#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grin/media/fields/parabolic.h"
#include "grin/rays/connections/geometric_spreading.h"
#include "grin/rays/marching/ray.h"
#include "grin/render/curved/ray_field_of.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

/// A ray of the parabolic guide in closed form (conventions, C27): x = x0 cos t + q sin t across
/// the axis, where t = alpha sigma and q = v / alpha. Along the axis the motion is uniform.
/// Positions are relative to the axis.
class ParabolicOrbit {
 public:
  /// n0: index on the axis.
  ParabolicOrbit(double n0, double alpha, const Vec3& x, const Vec3& v)
      : n0_(n0), alpha_(alpha), x_(x), v_(v) {
    const Vec x0 = x.head<2>(), q = v.head<2>() / alpha;
    squares_ = (x0.squaredNorm() + q.squaredNorm()) / 2;
    even_ = (x0.squaredNorm() - q.squaredNorm()) / 2;
    odd_ = x0.dot(q);
  }

  RayState place_at(double t) const {
    const double c = std::cos(t), s = std::sin(t);
    RayState ray{c * x_ + s / alpha_ * v_, c * v_ - alpha_ * s * x_};
    ray.x[2] = x_[2] + t / alpha_ * v_[2];
    ray.v[2] = v_[2];
    return ray;
  }
  /// Returns the state at t; arc length and optical path are counted from t = 0.
  RayState at(double t) const {
    RayState ray = place_at(t);
    ray.arc_length = arc_length(t);
    ray.optical_path = optical_path(t);
    return ray;
  }
  /// Returns the derivative of the state at t with respect to v at t = 0.
  RayTangent tangent_at(double t) const {
    RayTangent tangent;
    tangent.dx.diagonal() = Vec3(std::sin(t), std::sin(t), t) / alpha_;
    tangent.dv.diagonal() = Vec3(std::cos(t), std::cos(t), 1);
    return tangent;
  }

 private:
  using Vec = Eigen::Vector2d;

  double optical_path(double t) const {
    const double swings = even_ * std::sin(2 * t) / 2 + odd_ * std::sin(t) * std::sin(t);
    return (n0_ * n0_ * t - alpha_ * alpha_ * (squares_ * t + swings)) / alpha_;
  }
  /// Returns the arc length from 0 to t as an elliptic integral, since n^2 = mean + swing cos(2 t +
  /// phase) along the ray.
  double arc_length(double t) const {
    const double mean = n0_ * n0_ - alpha_ * alpha_ * squares_;
    const double swing = alpha_ * alpha_ * std::hypot(even_, odd_);
    const double phase = swing > 0 ? std::atan2(odd_, -even_) : 0;
    const double k = std::sqrt(std::min(2 * swing / (mean + swing), 1.0));
    const auto to = [&](double at) { return std::ellint_2(k, at + phase / 2); };
    return std::sqrt(mean + swing) / alpha_ * (to(t) - to(0));
  }

  double n0_, alpha_;
  Vec3 x_, v_;
  /// The squared distance from the axis is squares + even cos 2t + odd sin 2t.
  double squares_, even_, odd_;
};

/// All rays of the parabolic guide between two points. With t = alpha sigma of the whole ray, the
/// transverse momentum follows from the end points, and the longitudinal one from their distance
/// along the axis. The condition that |v| = n then becomes
///   P / (1 - cos t) + M / (1 + cos t) + (z / t)^2 = (n0 / alpha)^2,
/// where z is the distance along the axis, and P and M are half the squared transverse distances of
/// one end from the other and from its mirror image in the axis. As a function of t the left-hand
/// side is infinite at multiples of pi and convex between them, so that each interval has two roots
/// or none.
class ParabolicCurves {
 public:
  ParabolicCurves(double n0, double alpha, const Vec3& x0, const Vec3& x1)
      : alpha_(alpha),
        x0_(x0),
        x1_(x1),
        apart_((x1 - x0).head<2>().squaredNorm() / 2),
        from_image_((x1 + x0).head<2>().squaredNorm() / 2),
        along_(x1[2] - x0[2]),
        whole_(n0 / alpha * n0 / alpha) {}

  /// Calls use(t, start) for each ray with t up to `longest`, in increasing order of t. start:
  /// momentum v of the ray at x0.
  template <class Use>
  void each(double longest, const Use& use) const {
    using std::numbers::pi;
    const double shortest = std::abs(along_) / std::sqrt(whole_);
    for (int k = static_cast<int>(shortest / pi); k * pi < longest; ++k) {
      if (!has_roots(k)) continue;
      for (const Edge& edge : {Edge{k, 1}, Edge{k + 1, -1}}) {
        const double u = root(edge);
        const double t = edge.number * pi + edge.sense * u;
        if (u > 0 && u < pi && t <= longest) use(t, start(edge, u, t));
      }
    }
  }

 private:
  /// A multiple of pi, number pi, and the side of it (sense = 1 or -1) on which a root t lies. The
  /// root is represented by its distance u from the multiple: t = number pi + sense u.
  struct Edge {
    int number, sense;
    bool is_even() const { return number % 2 == 0; }
  };
  struct Value {
    double f, derivative;
  };

  /// Returns the left-hand side minus the right-hand side of the equation for t at t = number pi +
  /// sense u, and the derivative of the difference by u.
  Value at(const Edge& edge, double u) const {
    const double near = edge.is_even() ? apart_ : from_image_;
    const double far = edge.is_even() ? from_image_ : apart_;
    const double s = std::sin(u / 2), c = std::cos(u / 2);
    const double t = edge.number * std::numbers::pi + edge.sense * u, z = along_ / t;
    Value value{-whole_, 0};
    if (near > 0) value = {near / (2 * s * s) - whole_, -near * c / (2 * s * s * s)};
    if (far > 0)
      value = {value.f + far / (2 * c * c), value.derivative + far * s / (2 * c * c * c)};
    if (along_ != 0) value = {value.f + z * z, value.derivative - edge.sense * 2 * z * z / t};
    return value;
  }

  /// Whether the equation for t has two roots between k pi and (k + 1) pi, that is, whether its
  /// left-hand side minus its right-hand side has a negative minimum there. The minimum is located
  /// by bisection of the derivative until its sign is certain.
  bool has_roots(int k) const {
    const double across = std::sqrt(apart_) + std::sqrt(from_image_);
    const double least_along = along_ / ((k + 1) * std::numbers::pi);
    if (across * across / 2 + least_along * least_along >= whole_) return false;
    double low = 0, high = std::numbers::pi;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      const Value here = at({k, 1}, middle);
      if (here.f < 0) return true;
      const double other = here.derivative < 0 ? high : low;
      if (here.f + here.derivative * (other - middle) > 0)
        return false;  // a convex function is above its tangent
      (here.derivative < 0 ? low : high) = middle;
    }
    return false;
  }

  /// Returns the distance u of the root next to the multiple of pi given by `edge`; 0 if there is
  /// no root. Newton steps begin close to the multiple and do not pass the root, since the function
  /// is convex.
  double root(const Edge& edge) const {
    const double near = edge.is_even() ? apart_ : from_image_;
    const double least = (2 * near + (edge.number == 0 ? along_ * along_ : 0)) / whole_;
    double u = std::sqrt(least);  // u before the root, since 1 - cos u <= u^2 / 2
    if (!(u < std::numbers::pi)) return 0;
    for (int i = 0; i < 60; ++i) {
      const Value here = at(edge, u);
      if (!(here.derivative < 0)) return 0;
      const double step = -here.f / here.derivative;
      if (i == 0 && step < -1e-12 * u) return 0;
      u += step;
      if (!(u < std::numbers::pi)) return 0;
      if (step <= 1e-15 * u) return u;
    }
    return u;
  }

  Vec3 start(const Edge& edge, double u, double t) const {
    const double sign = edge.is_even() ? 1 : -1;
    const double cosine = sign * std::cos(u), sine = edge.sense * sign * std::sin(u);
    Vec3 v = alpha_ / sine * (x1_ - cosine * x0_);
    v[2] = alpha_ * along_ / t;
    return v;
  }

  double alpha_;
  Vec3 x0_, x1_;
  double apart_, from_image_, along_, whole_;
};

/// Whether rays in the region bend enough for the closed forms to be accurate. In a weaker guide
/// two points are connected by one nearly straight curve, which any trial of the iterative search
/// finds.
inline bool bends_within(const ParabolicGuide& field, const Surface& region) {
  constexpr double least_turn = 1e-2;
  const Box box = bounds(region);
  return field.profile().alpha * (box.high - box.low).norm() > least_turn;
}

/// Rays of the parabolic guide in a region. Flights are traced by numerical steps. Connections use
/// the closed form of all curves between two points, and select one of them at random.
class ParabolicRays final : public RayFieldOf<ParabolicGuide> {
 public:
  ParabolicRays(const ParabolicGuide& field, const Surface& region)
      : RayFieldOf(field),
        centre_(field.centre()),
        n0_(1 + field.profile().axis_excess),
        alpha_(field.profile().alpha) {
    const Box box = bounds(region);
    const Vec3 far = (box.low - centre_).cwiseAbs().cwiseMax((box.high - centre_).cwiseAbs());
    reach_squared_ = far.head<2>().squaredNorm();
  }

  double cost_of_curve() const override { return 1; }
  double cost_of_closed_curve() const override { return 2; }
  ConnectionEstimate connect(const CurveEndpoints& ends, const ConnectionOptions& options,
                             RandomStream& random,
                             ConnectionStatistics& statistics) const override {
    ConnectionEstimate found{TrialOutcome::no_approach, std::nullopt, 0};
    const Vec3 from = ends.from - centre_, to = ends.to - centre_;
    ParabolicCurves(n0_, alpha_, from, to)
        .each(longest(to[2] - from[2], options), [&](double t, const Vec3& v) {
          Connection curve;
          const TrialOutcome outcome = judge({n0_, alpha_, from, v}, t, ends, options, curve);
          if (!found.curve) found.outcome = outcome;
          if (outcome != TrialOutcome::converged) return;
          if (random.uniform() * ++found.multiplicity < 1) found.curve = curve;
        });
    statistics.add_pair(found.outcome);
    return found;
  }

 private:
  /// Returns the largest t of a curve whose ends are `along` apart along the axis; a curve of
  /// larger t leaves the region or exceeds max_length. The bound uses that the mean of n^2 along a
  /// ray is at least half of n^2 on the axis.
  double longest(double along, const ConnectionOptions& options) const {
    const double by_length = alpha_ * 2 * options.max_length / n0_ + 1;
    const double on_axis = n0_ / alpha_ * n0_ / alpha_ - reach_squared_;
    if (!(on_axis > 0)) return by_length;
    return std::min(by_length, std::max(std::numbers::pi, std::abs(along) / std::sqrt(on_axis)));
  }

  TrialOutcome judge(const ParabolicOrbit& orbit, double t, const CurveEndpoints& ends,
                     const ConnectionOptions& options, Connection& curve) const {
    const RayState start = orbit.at(0), end = orbit.at(t);
    if (!(end.arc_length <= options.max_length)) return TrialOutcome::too_long;
    const double sigma = t / alpha_, n = start.v.norm();
    const Vec3 first = start.v / n, last = end.v.normalized();
    const double spreading = signed_spreading(orbit.tangent_at(t), n, first, last);
    if (!(std::abs(spreading) > 0)) return TrialOutcome::degenerate;
    const int steps = static_cast<int>(std::ceil(sigma / options.step));
    if (!keeps(orbit, sigma / steps, steps, ends.region)) return TrialOutcome::left_region;
    curve = {first,
             last,
             sigma,
             end.arc_length,
             end.optical_path,
             std::abs(spreading),
             spreading < 0 ? -1 : 1,
             steps};
    return TrialOutcome::converged;
  }

  bool keeps(const ParabolicOrbit& orbit, double h, int steps, const Sides& region) const {
    RayState before = placed(orbit, 0);
    for (int i = 1; i <= steps; ++i) {
      const RayState here = placed(orbit, i * h);
      if (!region.keep(before, here, h)) return false;
      before = here;
    }
    return true;
  }
  /// Returns the state at sigma; its arc length is only an upper bound.
  RayState placed(const ParabolicOrbit& orbit, double sigma) const {
    RayState ray = orbit.place_at(alpha_ * sigma);
    ray.x += centre_;
    ray.arc_length = n0_ * sigma;
    return ray;
  }

  Vec3 centre_;
  double n0_, alpha_;
  double reach_squared_;  ///< largest squared distance of the region from the axis
};

}  // namespace flatspeckle::grin
