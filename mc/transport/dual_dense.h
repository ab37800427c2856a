#pragma once

#include <span>
#include <vector>

#include "mc/transport/dense.h"
#include "mc/transport/dual.h"

namespace flatspeckle::mc {

/// The matrices of calculations with a Number.
template <typename Number>
struct DenseNumbers {
  using RealMatrix = Matrix;
  using ComplexRows = Rows;
};
template <>
struct DenseNumbers<Complex> {
  using RealMatrix = Rows;
  using ComplexRows = Rows;
};
template <>
struct DenseNumbers<Dual<double>> {
  using RealMatrix = Dual<Matrix>;
  using ComplexRows = Dual<Rows>;
};
template <typename Number>
using MatrixOf = typename DenseNumbers<Number>::RealMatrix;
template <typename Number>
using RowsOf = typename DenseNumbers<Number>::ComplexRows;

/// f of a matrix, where f is linear.
template <typename F>
auto linear(const F& f, const Matrix& a) {
  return f(a);
}
template <typename F>
Rows linear(const F& f, const Rows& a) {
  return f(a);
}
template <typename F, typename T>
Dual<T> linear(const F& f, const Dual<T>& a) {
  return {f(a.value), f(a.slope)};
}

inline Matrix times(double factor, const Matrix& a) {
  return factor * a;
}
inline Rows times(Complex factor, const Matrix& a) {
  Rows b(a.rows(), a.cols());
  b.real() = factor.real() * a;
  b.imag() = factor.imag() * a;
  return b;
}
inline Dual<Matrix> times(const Dual<double>& factor, const Matrix& a) {
  return {factor.value * a, factor.slope * a};
}

inline Complex entry(const Rows& rows, Eigen::Index i, Eigen::Index j) {
  return rows(i, j);
}
inline Dual<Complex> entry(const Dual<Rows>& rows, Eigen::Index i, Eigen::Index j) {
  return {rows.value(i, j), rows.slope(i, j)};
}

inline Matrix identity_like(const Matrix& a) {
  return Matrix::Identity(a.rows(), a.cols());
}
inline Rows identity_like(const Rows& a) {
  return Rows::Identity(a.rows(), a.cols());
}
inline Dual<Matrix> identity_like(const Dual<Matrix>& a) {
  return {identity_like(a.value), Matrix::Zero(a.value.rows(), a.value.cols())};
}

template <typename A, typename B>
Dual<A> product(const Dual<A>& a, const Dual<B>& b) {
  return {product(a.value, b.value), product(a.slope, b.value) + product(a.value, b.slope)};
}
inline Dual<Rows> product_transposed(const Dual<Rows>& a, const Dual<Rows>& b) {
  return {product_transposed(a.value, b.value),
          product_transposed(a.slope, b.value) + product_transposed(a.value, b.slope)};
}
inline Dual<Matrix> inverse(const Dual<Matrix>& a) {
  const Matrix value = inverse(a.value);
  return {value, -product(product(value, a.slope), value)};
}
inline Dual<Rows> scaled(const std::vector<Dual<Complex>>& factor, const Dual<Rows>& rows) {
  const auto parts = flat(factor);
  const auto value = std::span(parts).first(factor.size()),
             slope = std::span(parts).last(factor.size());
  return {scaled(value, rows.value), scaled(slope, rows.value) + scaled(value, rows.slope)};
}

}  // namespace flatspeckle::mc
