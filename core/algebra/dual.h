#pragma once

#include <cmath>
#include <complex>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// A number or matrix with its derivative with respect to one parameter (forward-mode automatic
/// differentiation).
template <typename T>
struct Dual {
  T value{}, derivative{};

  Dual& operator+=(const Dual& other) {
    value += other.value;
    derivative += other.derivative;
    return *this;
  }
};

template <typename T>
Dual<T> operator+(const Dual<T>& a, const Dual<T>& b) {
  return {a.value + b.value, a.derivative + b.derivative};
}
template <typename T>
Dual<T> operator-(const Dual<T>& a, const Dual<T>& b) {
  return {a.value - b.value, a.derivative - b.derivative};
}
template <typename T>
Dual<T> operator-(const Dual<T>& a) {
  return {-a.value, -a.derivative};
}
/// Returns the product of two numbers, or of a number and a matrix, by the product rule.
template <typename A, typename B>
Dual<B> operator*(const Dual<A>& a, const Dual<B>& b) {
  return {a.value * b.value, a.derivative * b.value + a.value * b.derivative};
}
template <typename T>
Dual<T> operator*(double a, const Dual<T>& b) {
  return {a * b.value, a * b.derivative};
}
inline Dual<Complex> operator*(Complex a, const Dual<Complex>& b) {
  return {a * b.value, a * b.derivative};
}
inline Dual<Complex> operator*(Complex a, const Dual<double>& b) {
  return {a * b.value, a * b.derivative};
}
template <typename T>
Dual<T> operator/(const Dual<T>& a, const Dual<T>& b) {
  const T ratio = a.value / b.value;
  return {ratio, (a.derivative - ratio * b.derivative) / b.value};
}
template <typename T>
Dual<T> operator/(const Dual<T>& a, double b) {
  return {a.value / b, a.derivative / b};
}
inline Dual<double> operator/(double a, const Dual<double>& b) {
  return {a / b.value, -a / (b.value * b.value) * b.derivative};
}
template <typename T>
Dual<T> operator+(double a, const Dual<T>& b) {
  return {a + b.value, b.derivative};
}
template <typename T>
Dual<T> operator-(const Dual<T>& a, double b) {
  return {a.value - b, a.derivative};
}
inline Dual<Complex> exp(const Dual<Complex>& a) {
  const Complex value = std::exp(a.value);
  return {value, value * a.derivative};
}

template <typename T>
const T& value_of(const T& a) {
  return a;
}
template <typename T>
const T& value_of(const Dual<T>& a) {
  return a.value;
}

/// Evaluates an expression f(part), in which every number occurs as part(number): once for the
/// values of the numbers and, if Number is Dual<double>, once more for their derivatives. Returns
/// the result, for Dual<double> as a Dual of both. f must be linear in the numbers.
template <typename Number, typename F>
auto each_part(const F& f) {
  const auto value = [](const auto& number) { return value_of(number); };
  if constexpr (std::is_same_v<Number, Dual<double>>)
    return Dual<decltype(f(value))>{f(value), f([](const auto& dual) { return dual.derivative; })};
  else
    return f(value);
}

/// Type of the complex numbers in a calculation whose real numbers have the type Number.
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
  return {a.value, a.derivative};
}
inline Dual<Complex> as_complex(const Dual<Complex>& a) {
  return a;
}

/// Type of the quantities that stay real when Number is complex, such as the depths in a
/// calculation with a complex extinction coefficient.
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

/// Returns the values in one list, followed by the derivatives if the numbers are Duals.
inline std::vector<Complex> flat(std::vector<Complex> values) {
  return values;
}
inline std::vector<Complex> flat(const std::vector<Dual<Complex>>& list) {
  std::vector<Complex> all;
  for (const auto& dual : list) all.push_back(dual.value);
  for (const auto& dual : list) all.push_back(dual.derivative);
  return all;
}

/// Returns (exp(a) - exp(b)) / (a - b), without loss of digits if a and b are close.
template <typename C>
C divided_difference(C a, C b) {
  if (value_of(a).real() < value_of(b).real()) std::swap(a, b);
  const C z = b - a;
  if (std::abs(value_of(z)) < 1e-3)
    return exp(a) * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0 * (1.0 + z / 5.0))));
  return exp(a) * ((exp(z) - 1.0) / z);
}

}  // namespace flatspeckle
