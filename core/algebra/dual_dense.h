#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/algebra/dense.h"
#include "core/algebra/dual.h"

namespace flatspeckle {

/// Types of real and complex matrices in a calculation whose numbers have the type Number.
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

/// Applies a linear map f to a matrix, and to its derivative if it has one.
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
  return {f(a.value), f(a.derivative)};
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
  return {factor.value * a, factor.derivative * a};
}

inline Complex entry(const Rows& rows, Eigen::Index i, Eigen::Index j) {
  return rows(i, j);
}
inline Dual<Complex> entry(const Dual<Rows>& rows, Eigen::Index i, Eigen::Index j) {
  return {rows.value(i, j), rows.derivative(i, j)};
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

/// Returns the rows of one matrix followed by those of another.
inline Rows concatenated(const Rows& upper, const Rows& lower) {
  Rows both(upper.rows() + lower.rows(), upper.cols());
  both.topRows(upper.rows()) = upper;
  both.bottomRows(lower.rows()) = lower;
  return both;
}

inline Dual<Rows> concatenated(const Dual<Rows>& upper, const Dual<Rows>& lower) {
  return {concatenated(upper.value, lower.value), concatenated(upper.derivative, lower.derivative)};
}

/// Returns the columns of one matrix followed by those of another.
inline Rows beside(const Rows& left, const Rows& right) {
  Rows both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}
inline Dual<Rows> beside(const Dual<Rows>& left, const Dual<Rows>& right) {
  return {beside(left.value, right.value), beside(left.derivative, right.derivative)};
}

template <typename A, typename B>
Dual<A> product(const Dual<A>& a, const Dual<B>& b) {
  return {product(a.value, b.value),
          product(a.derivative, b.value) + product(a.value, b.derivative)};
}
inline Dual<Rows> product_transposed(const Dual<Rows>& a, const Dual<Rows>& b) {
  return {product_transposed(a.value, b.value),
          product_transposed(a.derivative, b.value) + product_transposed(a.value, b.derivative)};
}
inline Dual<Rows> scaled(const std::vector<Dual<Complex>>& factor, const Dual<Rows>& rows) {
  const auto parts = flat(factor);
  const auto value = std::span(parts).first(factor.size()),
             derivative = std::span(parts).last(factor.size());
  return {scaled(value, rows.value),
          scaled(derivative, rows.value) + scaled(value, rows.derivative)};
}

template <>
class FactorsOf<Dual<Matrix>> {
 public:
  explicit FactorsOf(Dual<Matrix> a)
      : of_value_(std::move(a.value)), derivative_(std::move(a.derivative)) {}
  Dual<Matrix> before(const Dual<Matrix>& b) const {
    const Matrix value = of_value_.before(b.value);
    return {value, of_value_.before(b.derivative - product(derivative_, value))};
  }
  Dual<Rows> after(const Dual<Rows>& rows) const {
    const Rows value = of_value_.after(rows.value);
    return {value, of_value_.after(rows.derivative - product(value, derivative_))};
  }

 private:
  FactorsOf<Matrix> of_value_;
  Matrix derivative_;
};

}  // namespace flatspeckle
