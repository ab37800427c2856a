#pragma once

#include <cmath>
#include <complex>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// A number or matrix with its derivative by one parameter; what is done to it follows the rules of
/// calculus (automatic differentiation, forward mode).
template <typename T>
struct Dual {
  T value{}, slope{};

  Dual& operator+=(const Dual& other) {
    value += other.value;
    slope += other.slope;
    return *this;
  }
};

template <typename T>
Dual<T> operator+(const Dual<T>& a, const Dual<T>& b) {
  return {a.value + b.value, a.slope + b.slope};
}
template <typename T>
Dual<T> operator-(const Dual<T>& a, const Dual<T>& b) {
  return {a.value - b.value, a.slope - b.slope};
}
template <typename T>
Dual<T> operator-(const Dual<T>& a) {
  return {-a.value, -a.slope};
}
/// Of numbers, or of a number and a matrix.
template <typename A, typename B>
Dual<B> operator*(const Dual<A>& a, const Dual<B>& b) {
  return {a.value * b.value, a.slope * b.value + a.value * b.slope};
}
template <typename T>
Dual<T> operator*(double a, const Dual<T>& b) {
  return {a * b.value, a * b.slope};
}
inline Dual<Complex> operator*(Complex a, const Dual<Complex>& b) {
  return {a * b.value, a * b.slope};
}
inline Dual<Complex> operator*(Complex a, const Dual<double>& b) {
  return {a * b.value, a * b.slope};
}
template <typename T>
Dual<T> operator/(const Dual<T>& a, const Dual<T>& b) {
  const T ratio = a.value / b.value;
  return {ratio, (a.slope - ratio * b.slope) / b.value};
}
template <typename T>
Dual<T> operator/(const Dual<T>& a, double b) {
  return {a.value / b, a.slope / b};
}
inline Dual<double> operator/(double a, const Dual<double>& b) {
  return {a / b.value, -a / (b.value * b.value) * b.slope};
}
template <typename T>
Dual<T> operator+(double a, const Dual<T>& b) {
  return {a + b.value, b.slope};
}
template <typename T>
Dual<T> operator-(const Dual<T>& a, double b) {
  return {a.value - b, a.slope};
}
inline Dual<Complex> exp(const Dual<Complex>& a) {
  const Complex value = std::exp(a.value);
  return {value, value * a.slope};
}

template <typename T>
const T& value_of(const T& a) {
  return a;
}
template <typename T>
const T& value_of(const Dual<T>& a) {
  return a.value;
}

/// What f(part) gives, where part(number) takes a number's value; for Dual<double> that and the
/// same with its slope.
template <typename Number, typename F>
auto each_part(const F& f) {
  const auto value = [](const auto& number) { return value_of(number); };
  if constexpr (std::is_same_v<Number, Dual<double>>)
    return Dual<decltype(f(value))>{f(value), f([](const auto& dual) { return dual.slope; })};
  else
    return f(value);
}

/// The complex numbers of calculations with a Number.
template <typename Number>
struct ComplexNumbers {
  using Type = Complex;
};
template <>
struct ComplexNumbers<Dual<double>> {
  using Type = Dual<Complex>;
};
template <typename Number>
using ComplexOf = typename ComplexNumbers<Number>::Type;

inline Complex as_complex(Complex a) {
  return a;
}
inline Dual<Complex> as_complex(const Dual<double>& a) {
  return {a.value, a.slope};
}
inline Dual<Complex> as_complex(const Dual<Complex>& a) {
  return a;
}

/// Calculations with complex extinction have real depths.
template <typename Number>
struct RealNumbers {
  using Type = Number;
};
template <>
struct RealNumbers<Complex> {
  using Type = double;
};
template <typename Number>
using RealOf = typename RealNumbers<Number>::Type;

/// Values, then derivatives.
inline std::vector<Complex> flat(std::vector<Complex> values) {
  return values;
}
inline std::vector<Complex> flat(const std::vector<Dual<Complex>>& list) {
  std::vector<Complex> all;
  for (const auto& dual : list) all.push_back(dual.value);
  for (const auto& dual : list) all.push_back(dual.slope);
  return all;
}

/// (exp(a) - exp(b)) / (a - b)
template <typename C>
C divided_difference(C a, C b) {
  if (value_of(a).real() < value_of(b).real()) std::swap(a, b);
  const C z = b - a;
  if (std::abs(value_of(z)) < 1e-3)
    return exp(a) * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0 * (1.0 + z / 5.0))));
  return exp(a) * ((exp(z) - 1.0) / z);
}

}  // namespace flatspeckle
