#pragma once

#include <array>

#include "grin/rays/marching/ray.h"

namespace flatspeckle::grin {

// One step h of a ray in the parameter sigma of C23: dx/dsigma = v, dv/dsigma = n grad n. These
// equations contain no root and no division, and their Hamiltonian H = (v^2 - n^2)/2 is separable.
// The length of a step is |v| h. Arc length and optical path are integrated to the same order as
// the ray.
//
//   Leapfrog   order 2, 1 gradient,  symplectic: drift h/2, kick h, drift h/2
//   Yoshida4   order 4, 3 gradients, symplectic: three leapfrogs [yoshida1990]
//   Sharma     order 4, 3 gradients: the Runge-Kutta-Nystroem scheme of Sharma, Kumar and Ghatak
//   1982
//
// The overload with a tangent also computes the exact derivative of the discrete step. The
// attribute `flatten` makes it 1.4 times as fast, because compilers do not inline operations on
// small matrices by themselves.

/// Makes an exact step of a straight ray.
inline void straight_step(const Homogeneous& field, RayState& ray, double h) {
  for (int half = 0; half < 2; ++half) ray.accumulate(1 + field.n_excess, h / 2);
  ray.x += h * ray.v;
}
inline void straight_step(const Homogeneous& field, RayState& ray, RayTangent& tangent, double h) {
  straight_step(field, ray, h);
  tangent.dx += h * tangent.dv;
}

/// Returns n grad n; ray_force_derivative() returns its derivative grad n grad n^T + n Hess n.
inline Vec3 ray_force(const IndexGradient& at) {
  return (1 + at.excess) * at.gradient;
}
inline Vec3 ray_force(const IndexHessian& at) {
  return (1 + at.excess) * at.gradient;
}
inline Mat3 ray_force_derivative(const IndexHessian& at) {
  return at.gradient * at.gradient.transpose() + (1 + at.excess) * at.hessian;
}

/// Index excess n - 1 and n grad n at a point. They are computed by field.force() if the field has
/// this function, otherwise from the gradient.
struct RayForce {
  double excess;
  Vec3 force;
};
template <IndexField F>
RayForce ray_force(const F& field, const Vec3& x) {
  if constexpr (requires { field.force(x); }) {
    const DiagonalForce at = field.force(x);
    return {at.excess, at.force};
  } else {
    const IndexGradient at = field.gradient(x);
    return {at.excess, ray_force(at)};
  }
}
template <class Derivative>
struct RayForceJet : RayForce {
  Derivative derivative;
};
template <IndexField F>
auto ray_force_jet(const F& field, const Vec3& x) {
  if constexpr (requires { field.force(x); }) {
    const DiagonalForce at = field.force(x);
    return RayForceJet<Eigen::DiagonalMatrix<double, 3>>{
        {at.excess, at.force}, Eigen::DiagonalMatrix<double, 3>(at.derivative)};
  } else {
    const IndexHessian at = field.hessian(x);
    return RayForceJet<Mat3>{{at.excess, ray_force(at)}, ray_force_derivative(at)};
  }
}

struct Leapfrog {
  static constexpr const char* word = "leapfrog";
  static constexpr int order = 2;

  template <IndexField F>
  [[gnu::flatten]] static void step(const F& field, RayState& ray, double h) {
    if constexpr (HomogeneousField<F>) return straight_step(field, ray, h);
    ray.x += h / 2 * ray.v;
    const RayForce at = ray_force(field, ray.x);
    ray.accumulate(1 + at.excess, h);
    ray.v += h * at.force;
    ray.x += h / 2 * ray.v;
  }

  template <IndexField F>
  [[gnu::flatten]] static void step(const F& field, RayState& ray, RayTangent& tangent, double h) {
    if constexpr (HomogeneousField<F>) return straight_step(field, ray, tangent, h);
    tangent.dx += h / 2 * tangent.dv;
    ray.x += h / 2 * ray.v;
    const auto at = ray_force_jet(field, ray.x);
    ray.accumulate(1 + at.excess, h);
    ray.v += h * at.force;
    ray.x += h / 2 * ray.v;
    tangent.dv += h * (at.derivative * tangent.dx);
    tangent.dx += h / 2 * tangent.dv;
  }
};

struct Yoshida4 {
  static constexpr const char* word = "yoshida4";
  static constexpr int order = 4;
  static constexpr double outer = 1.3512071919596576340476878089715;  ///< 1 / (2 - 2^(1/3))
  static constexpr double inner = 1 - 2 * outer;
  static constexpr std::array<double, 3> parts{outer, inner, outer};

  template <IndexField F>
  [[gnu::flatten]] static void step(const F& field, RayState& ray, double h) {
    if constexpr (HomogeneousField<F>) return straight_step(field, ray, h);
    for (const double part : parts) Leapfrog::step(field, ray, part * h);
  }

  template <IndexField F>
  static void step(const F& field, RayState& ray, RayTangent& tangent, double h) {
    if constexpr (HomogeneousField<F>) return straight_step(field, ray, tangent, h);
    for (const double part : parts) Leapfrog::step(field, ray, tangent, part * h);
  }
};

struct Sharma {
  static constexpr const char* word = "sharma";
  static constexpr int order = 4;

  template <IndexField F>
  [[gnu::flatten]] static void step(const F& field, RayState& ray, double h) {
    if constexpr (HomogeneousField<F>) return straight_step(field, ray, h);
    const RayForce a = ray_force(field, ray.x);
    const Vec3 middle = ray.x + h / 2 * ray.v + h * h / 8 * a.force;
    const RayForce b = ray_force(field, middle);
    const Vec3 end = ray.x + h * ray.v + h * h / 2 * b.force;
    const RayForce c = ray_force(field, end);
    accumulate(ray, a.excess, b.excess, c.excess, h);
    ray.x += h * ray.v + h * h / 6 * (a.force + 2 * b.force);
    ray.v += h / 6 * (a.force + 4 * b.force + c.force);
  }

  template <IndexField F>
  [[gnu::flatten]] static void step(const F& field, RayState& ray, RayTangent& tangent, double h) {
    if constexpr (HomogeneousField<F>) return straight_step(field, ray, tangent, h);
    const auto a = ray_force_jet(field, ray.x);
    const Mat3 da = a.derivative * tangent.dx;
    const Vec3 middle = ray.x + h / 2 * ray.v + h * h / 8 * a.force;
    const auto b = ray_force_jet(field, middle);
    const Mat3 db = b.derivative * (tangent.dx + h / 2 * tangent.dv + h * h / 8 * da);
    const Vec3 end = ray.x + h * ray.v + h * h / 2 * b.force;
    const auto c = ray_force_jet(field, end);
    const Mat3 dc = c.derivative * (tangent.dx + h * tangent.dv + h * h / 2 * db);
    accumulate(ray, a.excess, b.excess, c.excess, h);
    ray.x += h * ray.v + h * h / 6 * (a.force + 2 * b.force);
    ray.v += h / 6 * (a.force + 4 * b.force + c.force);
    tangent.dx += h * tangent.dv + h * h / 6 * (da + 2 * db);
    tangent.dv += h / 6 * (da + 4 * db + dc);
  }

 private:
  /// Integrates arc length and optical path by Simpson's rule from the excess at the start, in the
  /// middle and at the end of a step.
  static void accumulate(RayState& ray, double start, double middle, double end, double h) {
    ray.accumulate(1 + start, h / 6);
    ray.accumulate(1 + middle, 4 * h / 6);
    ray.accumulate(1 + end, h / 6);
  }
};

}  // namespace flatspeckle::grin
