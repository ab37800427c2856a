#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// A ray of Maxwell's fisheye in closed form (conventions, C27), lengths in units of its radius
/// from its centre: n = n0 / (1 + r^2), and rays are circles, x(s) = x + S w + C b, with the
/// curvature b = -2 (x - (x.w) w) / (1 + r^2), S = sin(ks)/k, C = (1 - cos(ks))/k^2, k = |b|. All
/// of it stays exact as k goes to 0, where the ray is straight.
class FisheyeOrbit {
 public:
  /// w: unit, along the ray.
  FisheyeOrbit(const Vec3& x, const Vec3& w)
      : x_(x),
        w_(w),
        over_(1 + x.squaredNorm()),
        outwards_(x.dot(w)),
        bend_(-2 / over_ * (x - outwards_ * w)),
        curvature_(bend_.norm()) {}

  double curvature() const { return curvature_; }
  double outwards() const { return outwards_; }
  const Vec3& start() const { return w_; }
  /// All around; infinite of a straight ray.
  double circumference() const { return 2 * std::numbers::pi / curvature_; }

  /// Where it is after an arc of s.
  struct Place {
    Vec3 x, w;
    double angle;  ///< optical path over n0/2
    double sigma;  ///< times n0
  };
  Place at(double s) const {
    const double half = curvature_ * s / 2;
    const double sine = s * sinc(2 * half), bulge = s * s / 2 * sinc(half) * sinc(half);
    return {x_ + sine * w_ + bulge * bend_,
            (1 - curvature_ * curvature_ * bulge) * w_ + sine * bend_, angle(s, half),
            over_ * s + 2 * bulge * outwards_ + 2 * lag(s, half) * (1 + x_.dot(bend_))};
  }

  /// The arc to where the ray leaves a sphere about the centre, in which it is; infinite where it
  /// never does. 0 of a ray on its way out from the sphere or beyond.
  double way_out(double radius) const {
    // r^2(s) - radius^2 is a quadratic in q = 2/k tan(ks/2), over 1 + (kq/2)^2
    const double inside = x_.squaredNorm() - radius * radius;
    if (inside >= 0 && outwards_ >= 0) return 0;
    const double square = inside * curvature_ * curvature_ / 4 + 1 + x_.dot(bend_);
    const double root = outwards_ * outwards_ - square * inside;
    if (root < 0) return inside < 0 ? std::numeric_limits<double>::infinity() : 0;
    const double q = outwards_ > 0 ? -inside / (outwards_ + std::sqrt(root))
                                   : (std::sqrt(root) - outwards_) / square;
    if (!(curvature_ > 0)) return q;
    const double s = 2 / curvature_ * std::atan(curvature_ * q / 2);
    return s >= 0 ? s : s + circumference();
  }

 private:
  static double sinc(double x) { return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x; }
  /// (s - S) / k^2.
  double lag(double s, double half) const {
    const double y = 4 * half * half;  // (ks)^2
    if (y < 0.01) return s * s * s / 6 * (1 - y / 20 * (1 - y / 42 * (1 - y / 72)));
    return (s - s * sinc(2 * half)) / (curvature_ * curvature_);
  }
  /// Between the two points on the sphere of which space is the image (stereographic).
  double angle(double s, double half) const {
    const double rounds = std::floor(half / std::numbers::pi);
    const double rest = half - rounds * std::numbers::pi;
    const double across = rounds > 0 ? 2 * std::sin(rest) / curvature_ : s * sinc(half);
    return 2 * (std::atan2(across, over_ * std::cos(rest) + outwards_ * across) +
                rounds * std::numbers::pi);
  }

  Vec3 x_, w_;
  double over_, outwards_;  ///< 1 + r^2, x.w
  Vec3 bend_;
  double curvature_;
};

/// The two ways between two points (apart, and not images of each other): the two arcs of one
/// circle, the first of which is less than half of all ways around by optical path.
struct FisheyeWays {
  Vec3 from;
  Vec3 start, end;        ///< unit, of the first; those of the second are opposite
  double arc, angle;      ///< of the first
  double root_spreading;  ///< sqrt |J| of both; 0 where the points are images

  FisheyeWays(const Vec3& x0, const Vec3& x1) : from(x0) {
    const double over = 1 + x0.squaredNorm(), apart = (x1 - x0).squaredNorm();
    const Vec3 along = x1 - x0 + apart / over * x0;
    start = along.normalized();
    const FisheyeOrbit orbit(x0, start);
    const double sine = along.norm() - apart / over * orbit.outwards(), k = orbit.curvature();
    arc = k > 0 ? 2 / k * std::atan2(k * apart / 2, sine) : apart / sine;
    end = orbit.at(arc).w;
    const double distance = std::sqrt(apart);
    const double from_image = std::hypot(1 + x0.dot(x1), x0.cross(x1).norm());
    angle = 2 * std::atan2(distance, from_image);
    root_spreading = distance * from_image / over;
  }
};

}  // namespace flatspeckle::grin
