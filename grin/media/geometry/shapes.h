#pragma once

#include <algorithm>
#include <cmath>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

// Surfaces in closed form. distance(x) is 0 on the surface and negative inside; |distance| never
// exceeds the true distance. normal(x) is the outward unit vector at a point on the surface.
// curvature(x) is d normal / d x at a point on the surface, for displacements along the surface.
// bounds() is the bounding box of a closed surface.

struct Box;

/// Whether computing x - centre would lose digits of x, because the radius of the sphere is much
/// larger than the coordinates of x.
inline bool is_wide(double radius, const Vec3& x) {
  return radius > 8 * x.cwiseAbs().maxCoeff();
}
/// Returns |x - centre|^2 - radius^2. For a wide sphere (is_wide), the rounding errors of the terms
/// without x are computed and added, so that the result is as exact as x.
inline double power_of_point(const Vec3& x, const Vec3& centre, double radius) {
  if (!is_wide(radius, x)) return (x - centre).squaredNorm() - radius * radius;
  double sum = 0, rest = 0;
  const auto add_product = [&](double a, double b) {
    const double product = a * b, before = sum;
    sum += product;
    const double added = sum - before;
    rest += (before - (sum - added)) + (product - added) + std::fma(a, b, -product);
  };
  for (int i = 0; i < 3; ++i) add_product(centre[i], centre[i]);
  add_product(-radius, radius);
  return sum + (rest + x.dot(x - 2 * centre));
}
/// Returns the signed distance from a sphere, without cancellation.
inline double distance_from_sphere(const Vec3& x, const Vec3& centre, double radius) {
  const double r = (x - centre).norm();
  return is_wide(radius, x) ? power_of_point(x, centre, radius) / (r + radius) : r - radius;
}

struct Sphere {
  Vec3 centre = Vec3::Zero();
  double radius = 1;

  double power(const Vec3& x) const { return power_of_point(x, centre, radius); }
  double distance(const Vec3& x) const { return distance_from_sphere(x, centre, radius); }
  Vec3 normal(const Vec3& x) const { return (x - centre).normalized(); }
  Mat3 curvature(const Vec3& x) const {
    const Vec3 n = normal(x);
    return (Mat3::Identity() - n * n.transpose()) / radius;
  }
  Box bounds() const;
};

/// A plane whose outside is the side that `outwards`, a unit vector, points to.
struct Plane {
  Vec3 point, outwards;

  double distance(const Vec3& x) const { return outwards.dot(x - point); }
  Vec3 normal(const Vec3&) const { return outwards; }
  Mat3 curvature(const Vec3&) const { return Mat3::Zero(); }
};

struct Box {
  Vec3 low, high;

  double distance(const Vec3& x) const {
    const Vec3 beyond = (low - x).cwiseMax(x - high);
    const bool is_inside = (beyond.array() < 0).all();  // false for NaN
    return is_inside ? beyond.maxCoeff() : beyond.cwiseMax(0).norm();
  }
  Vec3 normal(const Vec3& x) const {
    int axis;
    const Vec3 beyond = (low - x).cwiseMax(x - high);
    beyond.maxCoeff(&axis);
    return Vec3::Unit(axis) * (2 * x[axis] > low[axis] + high[axis] ? 1 : -1);
  }
  Mat3 curvature(const Vec3&) const { return Mat3::Zero(); }
  const Box& bounds() const { return *this; }
};

inline Box Sphere::bounds() const {
  return {centre - Vec3::Constant(radius), centre + Vec3::Constant(radius)};
}

/// Whether two boxes share no volume.
inline bool are_apart(const Box& a, const Box& b) {
  return (a.low.array() >= b.high.array()).any() || (b.low.array() >= a.high.array()).any();
}

}  // namespace flatspeckle::grin
