#pragma once

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Number value * 2^exponent, for numbers beyond the range of long double, such as Hankel functions
/// of orders in the thousands. The exponent is 0 for numbers within 2^-4096 .. 2^4096, so that
/// arithmetic with them takes little more time than with long double. Number: long double or
/// ExtendedComplex.
template <typename Number>
class Scaled {
 public:
  using value_type = long double;  // std::complex has a member type of this name too

  Scaled(Number value = 0, long exponent = 0) : value_(value), exponent_(exponent) {
    const long double size = magnitude(value_);
    if (size > 0x1p4096L && size < 0x1p16383L) shift(4096);
    if (size < 0x1p-4096L && size > 0) shift(-4096);
  }

  const Number& value() const { return value_; }
  long exponent() const { return exponent_; }

  /// Converts to a floating-point or complex type; the result is 0 or infinite if the number is out
  /// of range.
  template <typename Plain>
  explicit operator Plain() const {
    return static_cast<Plain>(exponent_ == 0 ? value_ : times_power(value_, exponent_));
  }

  Scaled& operator*=(const Number& factor) { return *this = {factor * value_, exponent_}; }
  Scaled operator-() const { return {-value_, exponent_}; }

  /// Returns the value for which value * 2^exponent, with the given exponent, is this number.
  Number value_at(long exponent) const {
    return exponent == exponent_ ? value_ : times_power(value_, exponent_ - exponent);
  }

 private:
  static long double magnitude(long double x) { return std::abs(x); }
  static long double magnitude(const ExtendedComplex& z) {
    return std::max(std::abs(z.real()), std::abs(z.imag()));
  }
  static long double times_power(long double x, long power) { return std::scalbln(x, power); }
  static ExtendedComplex times_power(const ExtendedComplex& z, long power) {
    return {std::scalbln(z.real(), power), std::scalbln(z.imag(), power)};
  }
  void shift(long power) {
    value_ = times_power(value_, -power);
    exponent_ += power;
  }

  Number value_;
  long exponent_;
};

using ScaledReal = Scaled<long double>;
using ScaledComplex = Scaled<ExtendedComplex>;

template <typename A, typename B>
auto operator*(const Scaled<A>& a, const Scaled<B>& b) {
  return Scaled<decltype(a.value() * b.value())>(a.value() * b.value(),
                                                 a.exponent() + b.exponent());
}
template <typename A, typename B>
auto operator*(const A& a, const Scaled<B>& b) {
  return Scaled<decltype(a * b.value())>(a * b.value(), b.exponent());
}
template <typename A, typename B>
auto operator*(const Scaled<A>& a, const B& b) {
  return b * a;
}
template <typename A, typename B>
auto operator/(const Scaled<A>& a, const Scaled<B>& b) {
  return Scaled<decltype(a.value() / b.value())>(a.value() / b.value(),
                                                 a.exponent() - b.exponent());
}
template <typename A, typename B>
auto operator+(const Scaled<A>& a, const Scaled<B>& b) {
  const long exponent = a.value() == A(0)   ? b.exponent()
                        : b.value() == B(0) ? a.exponent()
                                            : std::max(a.exponent(), b.exponent());
  return Scaled<decltype(a.value() + b.value())>(a.value_at(exponent) + b.value_at(exponent),
                                                 exponent);
}
template <typename A, typename B>
auto operator-(const Scaled<A>& a, const Scaled<B>& b) {
  return a + -b;
}

template <typename Number>
ScaledReal abs(const Scaled<Number>& a) {
  return {std::abs(a.value()), a.exponent()};
}
inline ScaledReal sqrt(const ScaledReal& a) {  // exponents are even, so that exponent / 2 is exact
  return {std::sqrt(a.value()), a.exponent() / 2};
}
/// Returns log2 of a number >= 0; -infinity for 0.
inline double log2(const ScaledReal& a) {
  return static_cast<double>(std::log2(a.value())) + static_cast<double>(a.exponent());
}

}  // namespace flatspeckle
