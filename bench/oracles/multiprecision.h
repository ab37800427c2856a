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

/// |found - exact| / |exact|
inline double relative_error(const WideComplex& found, const WideComplex& exact) {
  return static_cast<double>(abs(found - exact) / abs(exact));
}

/// J_{n+1}(z) / J_n(z) for n = 0 .. order by recurrence downwards.
std::vector<WideComplex> wide_bessel_ratios(int order, const WideComplex& z);

/// T_n of a cylinder: C7 word for word.
WideComplex wide_t(const Scatterer& cylinder, double k, int n);

}  // namespace flatspeckle::oracles
