#pragma once

#include "grin/media/index/index_field.h"

namespace flatspeckle::grin {

inline constexpr double light_speed = 299'792'458;  ///< m/s

/// A point of a ray. v points along the ray and |v| = n(x) (conventions, C23).
struct RayState {
  Vec3 x, v;
  double arc_length = 0, optical_path = 0;

  /// What a stretch dsigma of index n adds: ds = n dsigma, n ds = n^2 dsigma.
  void accumulate(double n, double dsigma) {
    arc_length += n * dsigma;
    optical_path += n * n * dsigma;
  }
};

/// At x towards `direction` (any length but 0).
template <IndexField F>
RayState start_ray(const F& field, const Vec3& x, const Vec3& direction) {
  return {x, index(field, x) * direction.normalized()};
}

/// Derivative of (x, v) by the start vector v0, all three components of it; what v0 does to |v| is
/// the user's to project out.
struct RayTangent {
  Mat3 dx = Mat3::Zero(), dv = Mat3::Identity();
};

}  // namespace flatspeckle::grin
