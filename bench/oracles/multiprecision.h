#pragma once

#include <vector>

#include <boost/multiprecision/cpp_complex.hpp>

#include "bench/oracles/bessel_oracle.h"
#include "core/numbers/scaled.h"
#include "flatland/scatterers/scatterer.h"

namespace flatspeckle::oracles {

using WideComplex = boost::multiprecision::cpp_complex_50;

inline Wide wide(const ScaledReal& a) {
  return ldexp(Wide(a.value()), static_cast<int>(a.exponent()));
}
inline WideComplex wide(const ScaledComplex& a) {
  return {wide(ScaledReal(a.value().real(), a.exponent())),
          wide(ScaledReal(a.value().imag(), a.exponent()))};
}
inline WideComplex wide(ExtendedComplex a) {
  return {Wide(a.real()), Wide(a.imag())};
}

/// Returns |found - exact| / |exact|.
inline double relative_error(const WideComplex& found, const WideComplex& exact) {
  return static_cast<double>(abs(found - exact) / abs(exact));
}

/// Returns J_{n+1}(z) / J_n(z) for n = 0 .. order by downward recurrence.
std::vector<WideComplex> wide_bessel_ratios(int order, const WideComplex& z);

/// Returns T_n of a cylinder, by the formula of C7 in 50 digits.
WideComplex wide_t(const Scatterer& cylinder, double k, int n);

}  // namespace flatspeckle::oracles
