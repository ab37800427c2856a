#pragma once

#include <complex>

namespace flatspeckle {

using Complex = std::complex<double>;

/// Wide exponent range (1e-4932 .. 1e4932 on x86-64): holds T_n and H_n where double over- or
/// underflows.
using ExtendedComplex = std::complex<long double>;

/// a b and a conj(b) without the language's care for infinite operands, which costs a branch.
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
