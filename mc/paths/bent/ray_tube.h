#pragma once

#include <cmath>

#include "flatland/media/domain.h"

namespace flatspeckle::mc {

/// n^2, and n grad n, which bends rays, of a field in the plane.
struct Bend {
  double square;
  Vec2 force;
};
/// The same and the force's derivatives.
struct BentBend : Bend {
  double xx, xz, zz;
};

/// A ray in the parameter sigma (conventions, C30): x' = v, v' = n grad n, |v| = n.
struct BentRay {
  Vec2 x, v;
};

/// A ray, its optical path, and how it moves as its direction turns where it begins.
struct RayTube : BentRay {
  Vec2 y, w;  ///< derivatives of x and v by that angle
  double path = 0;

  static RayTube from(Vec2 x, Vec2 v) { return {{x, v}, {}, {v.z, -v.x}, 0}; }
  /// J (C32); its sign changes at caustics.
  double spread() const { return y.x * v.z - y.z * v.x; }
};

/// Nystrom's method of fourth order.
template <typename BendAt>
BentRay stepped(const BentRay& ray, double h, const BendAt& bend) {
  const auto [x, v] = ray;
  const Vec2 a = bend(x).force, b = bend(x + h / 2 * v + h * h / 8 * a).force,
             c = bend(x + h * v + h * h / 2 * b).force;
  return {x + h * v + h * h / 6 * (a + 2 * b), v + h / 6 * (a + 4 * b + c)};
}

/// The same of a tube: the derivative of the step itself, and Simpson's rule of the path.
template <typename BentBendAt>
RayTube stepped(const RayTube& tube, double h, const BentBendAt& bend) {
  const auto turned = [](const BentBend& at, Vec2 y) {
    return Vec2{at.xx * y.x + at.xz * y.z, at.xz * y.x + at.zz * y.z};
  };
  const Vec2 x = tube.x, v = tube.v, y = tube.y, w = tube.w;
  const BentBend first = bend(x);
  const Vec2 a = first.force, ya = turned(first, y);
  const BentBend second = bend(x + h / 2 * v + h * h / 8 * a);
  const Vec2 b = second.force, yb = turned(second, y + h / 2 * w + h * h / 8 * ya);
  const BentBend third = bend(x + h * v + h * h / 2 * b);
  const Vec2 c = third.force, yc = turned(third, y + h * w + h * h / 2 * yb);
  RayTube next;
  next.x = x + h * v + h * h / 6 * (a + 2 * b);
  next.v = v + h / 6 * (a + 4 * b + c);
  next.y = y + h * w + h * h / 6 * (ya + 2 * yb);
  next.w = w + h / 6 * (ya + 4 * yb + yc);
  next.path = tube.path + h / 6 * (first.square + 4 * second.square + third.square);
  return next;
}

}  // namespace flatspeckle::mc
