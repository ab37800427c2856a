#pragma once

#include <complex>

namespace flatspeckle {

using Complex = std::complex<double>;

/// Complex number with a wide exponent range (1e-4932 .. 1e4932 on x86-64), for elements T_n of
/// T-matrices and Hankel functions H_n beyond the range of double.
using ExtendedComplex = std::complex<long double>;

/// Returns the product a b. Unlike operator*, it does not treat infinite operands specially, and
/// therefore needs no branch. product_with_conjugate() returns a conj(b), also without a branch.
template <typename Real>
std::complex<Real> product(std::complex<Real> a, std::complex<Real> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
inline Complex product(Complex a, double b) {
  return {a.real() * b, a.imag() * b};
}
inline Complex product_with_conjugate(Complex a, Complex b) {
  return {a.real() * b.real() + a.imag() * b.imag(), a.imag() * b.real() - a.real() * b.imag()};
}

}  // namespace flatspeckle
