#pragma once

#include <algorithm>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

// Surfaces in closed form: 0 is distance(x) on the surface, negative inside. |distance| is nowhere
// more than the true distance. normal(x) is a unit vector outwards, meant for points on the
// surface. curvature(x) is d normal / d x at a point on the surface, for displacements along it;
// bounds() the box around a closed one.

struct Box;

struct Sphere {
  Vec3 centre = Vec3::Zero();
  double radius = 1;

  double distance(const Vec3& x) const { return (x - centre).norm() - radius; }
  Vec3 normal(const Vec3& x) const { return (x - centre).normalized(); }
  Mat3 curvature(const Vec3& x) const {
    const Vec3 n = normal(x);
    return (Mat3::Identity() - n * n.transpose()) / radius;
  }
  Box bounds() const;
};

/// Outside is the side that `outwards`, a unit vector, points to.
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
    const bool is_inside = (beyond.array() < 0).all();  // never with NaN
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

/// Boxes that share no volume.
inline bool are_apart(const Box& a, const Box& b) {
  return (a.low.array() >= b.high.array()).any() || (b.low.array() >= a.high.array()).any();
}

}  // namespace flatspeckle::grin
