#pragma once

#include <concepts>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::grin {

/// Of an index field, at places all over its part of the stage.
struct IndexRange {
  double lowest = 1, highest = 1;
};

/// n = 1 + excess. A field computes the excess as such: an index of 1 + 1e-6 keeps all its digits.
struct IndexGradient {
  double excess;
  Vec3 gradient;  ///< 1/length
};
struct IndexHessian {
  double excess;
  Vec3 gradient;
  Mat3 hessian;  ///< 1/length^2, symmetric
};

/// n grad n, which bends rays, and its derivative; of a field where that is diagonal.
struct DiagonalForce {
  double excess;
  Vec3 force;       ///< 1/length
  Vec3 derivative;  ///< 1/length^2
};

/// A refractive index n(x) > 0 in space, twice differentiable but for surfaces that the field
/// names. Where n^2 is a sum of squares, field.force(x) may tell a DiagonalForce.
template <class F>
concept IndexField = requires(const F& field, const Vec3& x) {
  { field.excess(x) } -> std::same_as<double>;
  { field.gradient(x) } -> std::same_as<IndexGradient>;
  { field.hessian(x) } -> std::same_as<IndexHessian>;
};

/// The same index everywhere. Code that meets it at compile time runs no solver.
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
