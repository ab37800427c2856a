#pragma once

#include "grin/media/index/index_field.h"

namespace flatspeckle::grin {

/// A point of a ray. v points along the ray and |v| = n(x) (conventions, C23).
struct RayState {
  Vec3 x, v;
  double arc_length = 0, optical_path = 0;

  /// Adds a segment of length dsigma in sigma (C23), at index n, to the arc length (ds = n dsigma)
  /// and to the optical path (n ds = n^2 dsigma).
  void accumulate(double n, double dsigma) {
    arc_length += n * dsigma;
    optical_path += n * n * dsigma;
  }
};

/// Returns the state of a ray that starts at x along `direction`, a vector of any length except 0.
template <IndexField F>
RayState start_ray(const F& field, const Vec3& x, const Vec3& direction) {
  return {x, index(field, x) * direction.normalized()};
}

/// Derivative of the state (x, v) of a ray with respect to all three components of its start vector
/// v0. Code that uses this derivative projects out the change of |v0|.
struct RayTangent {
  Mat3 dx = Mat3::Zero(), dv = Mat3::Identity();
};

}  // namespace flatspeckle::grin
