#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/scaled.h"

namespace flatspeckle {

/// J_n(x) for n = 0 .. order at any order; x > 0. As accurate as bessel_j.
std::vector<ScaledReal> scaled_bessel_j(int order, double x);

/// H_n(x) of the first kind for n = 0 .. order at any order; x > 0. As accurate as hankel.
std::vector<ScaledComplex> scaled_hankel(int order, double x);

// Cylinder functions of integer order in extended range: neither H_n at n >> x overflows nor J_n
// underflows. Real arguments are > 0.

/// r_n = J_{n+1}(z) / J_n(z) for n = 0 .. order by downward recurrence from beyond |z|, in full
/// extended precision; where J_n oscillates, up to 1e-19 |z| (1 + |r_n|^2). Holds for large |Im z|
/// too, where J_n itself would overflow.
std::vector<ExtendedComplex> bessel_ratios(int order, ExtendedComplex z);

/// J_n(x) for n = 0 .. order in full extended precision: relative to |J_n| beyond n = x, to |H_n|
/// below.
std::vector<long double> bessel_j(int order, double x);

/// H_n(x) of the first kind for n = 0 .. h.size() - 1; relative error about 1e-15 of |H_n|.
void hankel(double x, std::span<ExtendedComplex> h);
std::vector<ExtendedComplex> hankel(int order, double x);

/// C_n'(x) = (n / x) C_n(x) - C_{n+1}(x) of J or H, from values[n] and values[n + 1].
template <typename Values>
auto cylinder_derivative(const Values& values, int n, long double x) {
  return (static_cast<long double>(n) / x) * values[n] - values[n + 1];
}

}  // namespace flatspeckle
