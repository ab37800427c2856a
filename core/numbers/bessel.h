#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/scaled.h"

namespace flatspeckle {

/// Radial functions of waves: J_n and H_n around cylinders, or the spherical j_n = sqrt(pi / (2 x))
/// J_{n+1/2} and h_n around spheres. The recurrences and derivatives below hold for both kinds.
enum class Radial { cylindrical, spherical };

/// Returns J_n(x) or j_n(x), x > 0, for n = 0 .. order, without underflow at any order. The error
/// is that of bessel_j().
std::vector<ScaledReal> scaled_bessel_j(int order, double x, Radial kind = Radial::cylindrical);

/// Returns the Hankel functions of the first kind H_n(x) or h_n(x), x > 0, for n = 0 .. order,
/// without overflow at any order. The error is that of hankel().
std::vector<ScaledComplex> scaled_hankel(int order, double x, Radial kind = Radial::cylindrical);

// The functions below are long double, whose exponent range avoids overflow of H_n and underflow of
// J_n at n >> x. Real arguments x must be positive.

/// Returns r_n = J_{n+1}(z) / J_n(z) for n = 0 .. order by downward recurrence that begins at an
/// order above |z|. The results are accurate to long double; at orders below |z|, where J_n
/// oscillates, the error is up to 1e-19 |z| (1 + |r_n|^2). Valid also for large |Im z|, where J_n
/// itself would overflow.
std::vector<ExtendedComplex> bessel_ratios(int order, ExtendedComplex z,
                                           Radial kind = Radial::cylindrical);

/// Returns J_n(x) or j_n(x) for n = 0 .. order to the precision of long double. This is the error
/// relative to |J_n| for n > x and relative to |H_n| for n < x.
std::vector<long double> bessel_j(int order, double x, Radial kind = Radial::cylindrical);

/// Computes the Hankel functions of the first kind H_n(x) or h_n(x) for n = 0 .. h.size() - 1, with
/// a relative error of about 1e-15 (h_n: 1e-18).
void hankel(double x, std::span<ExtendedComplex> h, Radial kind = Radial::cylindrical);
std::vector<ExtendedComplex> hankel(int order, double x, Radial kind = Radial::cylindrical);

/// Returns the derivative C_n'(x) = (n / x) C_n(x) - C_{n+1}(x), where C is J or H, from values[n]
/// = C_n(x) and values[n + 1]. It holds for j_n and h_n too.
template <typename Values>
auto cylinder_derivative(const Values& values, int n, long double x) {
  return (static_cast<long double>(n) / x) * values[n] - values[n + 1];
}

}  // namespace flatspeckle
