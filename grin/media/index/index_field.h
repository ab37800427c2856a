#pragma once

#include <concepts>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Lowest and highest index of a field, sampled over the region of the scene that the field fills.
struct IndexRange {
  double lowest = 1, highest = 1;
};

/// Index n = 1 + excess and its gradient. Fields compute n - 1 (the excess) directly, so that an
/// index of 1 + 1e-6 keeps all its digits.
struct IndexGradient {
  double excess;
  Vec3 gradient;  ///< gradient of n, 1/length
};
struct IndexHessian {
  double excess;
  Vec3 gradient;
  Mat3 hessian;  ///< second derivatives of n, 1/length^2, symmetric
};

/// The vector n grad n, which bends rays, and its derivative, for fields where the derivative is a
/// diagonal matrix.
struct DiagonalForce {
  double excess;
  Vec3 force;       ///< n grad n, 1/length
  Vec3 derivative;  ///< diagonal of the derivative of `force`, 1/length^2
};

/// A refractive index n(x) > 0 in space, twice differentiable except on the surfaces listed in
/// FieldFacts. If n^2 is a constant plus a weighted sum of squared coordinates, field.force(x) may
/// return a DiagonalForce.
template <class F>
concept IndexField = requires(const F& field, const Vec3& x) {
  { field.excess(x) } -> std::same_as<double>;
  { field.gradient(x) } -> std::same_as<IndexGradient>;
  { field.hessian(x) } -> std::same_as<IndexHessian>;
};

/// A uniform index. Code that is compiled for this type does not use a ray solver.
struct Homogeneous {
  double n_excess = 0;

  double excess(const Vec3&) const { return n_excess; }
  IndexGradient gradient(const Vec3&) const { return {n_excess, Vec3::Zero()}; }
  IndexHessian hessian(const Vec3&) const { return {n_excess, Vec3::Zero(), Mat3::Zero()}; }
};

template <class F>
concept HomogeneousField = std::same_as<F, Homogeneous>;

template <IndexField F>
double index(const F& field, const Vec3& x) {
  return 1 + field.excess(x);
}

}  // namespace flatspeckle::grin
