#pragma once

#include <algorithm>

#include <doctest/doctest.h>

#include "grin/media/index/index_field.h"

namespace flatspeckle::grin::tests {

/// Returns the derivative of f along `axis` at x, extrapolated from central differences with steps
/// h, h/2 and h/4. The error is of order h^6.
template <class Function>
auto derivative(const Function& f, const Vec3& x, int axis, double h) {
  const auto difference = [&](double step) {
    const Vec3 shift = step * Vec3::Unit(axis);
    return ((f(x + shift) - f(x - shift)) / (2 * step)).eval();
  };
  const auto d0 = difference(h), d1 = difference(h / 2), d2 = difference(h / 4);
  const auto e0 = ((4 * d1 - d0) / 3).eval(), e1 = ((4 * d2 - d1) / 3).eval();
  return ((16 * e1 - e0) / 15).eval();
}

/// Checks the gradient against values and the Hessian against gradients, and that all three agree
/// on common quantities. `length`: distance over which the field varies; `size`: magnitude of its
/// variation.
template <IndexField F>
void check_derivatives(const F& field, const Vec3& x, double length, double size,
                       double tolerance = 1e-9) {
  CAPTURE(x.transpose());
  const double h = length / 16;
  const IndexGradient first = field.gradient(x);
  const IndexHessian second = field.hessian(x);
  CHECK(std::abs(first.excess - field.excess(x)) <= 4e-15 * size);
  CHECK(std::abs(second.excess - field.excess(x)) <= 4e-15 * size);
  CHECK((second.gradient - first.gradient).norm() <= 1e-13 * size / length);
  const auto value = [&](const Vec3& at) { return Eigen::Matrix<double, 1, 1>(field.excess(at)); };
  const auto gradient_at = [&](const Vec3& at) { return field.gradient(at).gradient; };
  Vec3 gradient;
  Mat3 hessian;
  for (int i = 0; i < 3; ++i) {
    gradient[i] = derivative(value, x, i, h)[0];
    hessian.col(i) = derivative(gradient_at, x, i, h);
  }
  CHECK((gradient - first.gradient).norm() <= tolerance * size / length);
  CHECK((hessian - second.hessian).norm() <= tolerance * size / (length * length));
  CHECK((second.hessian - second.hessian.transpose()).norm() <= 1e-15 * size / (length * length));
}

}  // namespace flatspeckle::grin::tests
