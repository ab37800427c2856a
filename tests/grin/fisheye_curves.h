#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::oracles {

using grin::Vec3;

/// Rays of Maxwell's fisheye n = n0 / (1 + r^2/a^2) in closed form, by stereographic projection
/// onto a sphere of radius R = n0 a/2 in four dimensions. The rays become great circles; lengths on
/// the sphere are optical paths, and angles are preserved.
class FisheyeCurves {
 public:
  using Vec4 = Eigen::Vector4d;

  FisheyeCurves(double n0, double a) : n0_(n0), a_(a) {}

  double index(const Vec3& x) const { return n0_ / (1 + x.squaredNorm() / (a_ * a_)); }
  double radius() const { return n0_ * a_ / 2; }

  /// A great circle that starts at P, parametrised by the angle alpha along it.
  struct Circle {
    Vec4 start, tangent;
    Vec4 at(double alpha) const { return start * std::cos(alpha) + tangent * std::sin(alpha); }
    Vec4 along(double alpha) const { return -start * std::sin(alpha) + tangent * std::cos(alpha); }
  };
  Circle circle(const Vec3& from, const Vec3& direction) const {
    return {lifted(from), lifted_direction(from, direction)};
  }
  /// Returns the great circle along the shorter arc from P to Q; sets `angle` to the angle between
  /// P and Q.
  Circle circle_between(const Vec3& p, const Vec3& q, double& angle) const {
    const Vec4 u = lifted(p), w = lifted(q);
    const Vec4 across = w - u.dot(w) * u;
    angle = std::atan2(across.norm(), u.dot(w));
    return {u, across.normalized()};
  }

  Vec3 point(const Vec4& u) const { return a_ * u.head<3>() / (1 - u[3]); }
  Vec3 direction(const Vec4& u, const Vec4& along) const {
    const double h = 1 - u[3];
    const Vec3 d = along.head<3>() / h + u.head<3>() * along[3] / (h * h);
    return d.normalized();
  }

 private:
  Vec4 lifted(const Vec3& x) const {
    const double r2 = x.squaredNorm(), a2 = a_ * a_;
    Vec4 u;
    u << 2 * a_ * x / (r2 + a2), (r2 - a2) / (r2 + a2);
    return u;
  }
  Vec4 lifted_direction(const Vec3& x, const Vec3& d) const {
    const double r2 = x.squaredNorm(), a2 = a_ * a_, s = r2 + a2, xd = x.dot(d);
    Vec4 t;
    t << (2 * a_ * d * s - 4 * a_ * xd * x) / (s * s), 4 * a2 * xd / (s * s);
    return t.normalized();
  }

  double n0_, a_;
};

}  // namespace flatspeckle::oracles
