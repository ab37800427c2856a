#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grin/rays/marching/ray.h"

namespace flatspeckle::grin {

/// A ray of the parabolic guide in closed form (conventions, C27): x = x0 cos t + q sin t across
/// the axis, where t = alpha sigma and q = v / alpha, and even along it. Places count from the
/// axis.
class ParabolicOrbit {
 public:
  /// n0: on the axis.
  ParabolicOrbit(double n0, double alpha, const Vec3& x, const Vec3& v)
      : n0_(n0), alpha_(alpha), x_(x), v_(v) {
    const Vec2 x0 = x.head<2>(), q = v.head<2>() / alpha;
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
  /// With arc length and optical path since t = 0.
  RayState at(double t) const {
    RayState ray = place_at(t);
    ray.arc_length = arc_length(t);
    ray.optical_path = optical_path(t);
    return ray;
  }
  /// Its derivative by v.
  RayTangent tangent_at(double t) const {
    RayTangent tangent;
    tangent.dx.diagonal() = Vec3(std::sin(t), std::sin(t), t) / alpha_;
    tangent.dv.diagonal() = Vec3(std::cos(t), std::cos(t), 1);
    return tangent;
  }

 private:
  using Vec2 = Eigen::Vector2d;

  double optical_path(double t) const {
    const double swings = even_ * std::sin(2 * t) / 2 + odd_ * std::sin(t) * std::sin(t);
    return (n0_ * n0_ * t - alpha_ * alpha_ * (squares_ * t + swings)) / alpha_;
  }
  /// n^2 = mean + swing cos(2 t + phase): an elliptic integral.
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
  double squares_, even_, odd_;  ///< of the squared distance from the axis: its mean and swings
};

/// All rays of the parabolic guide between two places. With t = alpha sigma of the whole way, the
/// rays' momentum across follows from the ends, that along from the distance, and |v| = n is
///   P / (1 - cos t) + M / (1 + cos t) + (z / t)^2 = (n0 / alpha)^2,
/// P and M half the squared distances, across, of one end from the other and from its image. The
/// left side is convex between multiples of pi and infinite there: two roots or none.
class ParabolicWays {
 public:
  ParabolicWays(double n0, double alpha, const Vec3& x0, const Vec3& x1)
      : alpha_(alpha),
        x0_(x0),
        x1_(x1),
        apart_((x1 - x0).head<2>().squaredNorm() / 2),
        from_image_((x1 + x0).head<2>().squaredNorm() / 2),
        along_(x1[2] - x0[2]),
        whole_(n0 / alpha * n0 / alpha) {}

  /// use(t, start): t and the momentum v at x0 of each ray with t up to `longest`, shorter first.
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
  /// Roots are told by how far from a multiple of pi they are, in which direction.
  struct Edge {
    int number, sense;
    bool is_even() const { return number % 2 == 0; }
  };
  struct Value {
    double f, slope;
  };

  /// Left side less right side, and its derivative by u.
  Value at(const Edge& edge, double u) const {
    const double near = edge.is_even() ? apart_ : from_image_;
    const double far = edge.is_even() ? from_image_ : apart_;
    const double s = std::sin(u / 2), c = std::cos(u / 2);
    const double t = edge.number * std::numbers::pi + edge.sense * u, z = along_ / t;
    Value value{-whole_, 0};
    if (near > 0) value = {near / (2 * s * s) - whole_, -near * c / (2 * s * s * s)};
    if (far > 0) value = {value.f + far / (2 * c * c), value.slope + far * s / (2 * c * c * c)};
    if (along_ != 0) value = {value.f + z * z, value.slope - edge.sense * 2 * z * z / t};
    return value;
  }

  /// Whether the least value between k pi and the next multiple is below 0: bisection of its slope,
  /// which is seldom followed to the end.
  bool has_roots(int k) const {
    const double across = std::sqrt(apart_) + std::sqrt(from_image_);
    const double least_along = along_ / ((k + 1) * std::numbers::pi);
    if (across * across / 2 + least_along * least_along >= whole_) return false;
    double low = 0, high = std::numbers::pi;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      const Value here = at({k, 1}, middle);
      if (here.f < 0) return true;
      const double other = here.slope < 0 ? high : low;
      if (here.f + here.slope * (other - middle) > 0) return false;  // convex
      (here.slope < 0 ? low : high) = middle;
    }
    return false;
  }

  /// The root next to an edge by Newton's steps from the edge's side, which do not pass it, as the
  /// function is convex. 0 where there is none.
  double root(const Edge& edge) const {
    const double near = edge.is_even() ? apart_ : from_image_;
    const double least = (2 * near + (edge.number == 0 ? along_ * along_ : 0)) / whole_;
    double u = std::sqrt(least);  // the function is not below 0 there: 1 - cos u <= u^2 / 2
    if (!(u < std::numbers::pi)) return 0;
    for (int i = 0; i < 60; ++i) {
      const Value here = at(edge, u);
      if (!(here.slope < 0)) return 0;
      const double step = -here.f / here.slope;
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

}  // namespace flatspeckle::grin
