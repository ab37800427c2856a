#pragma once

#include <array>
#include <span>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// c[m] t^m
template <int degree>
using Polynomial = std::array<double, degree + 1>;

/// H_0 or H_1 in two pieces, fitted at the first call to libm's functions of extended precision.
/// The first Chebyshev coefficient left out is below 1e-17 of |H|.
struct HankelFit {
  static constexpr double border = 4;
  static constexpr int outer_degree = 19, inner_degree = 12;

  /// Above the border: sqrt(x) e^{-ix} H_n(x) in t = 2 border / x - 1.
  Polynomial<outer_degree> outer_re, outer_im;
  /// Below it, in t = 2 (x / border)^2 - 1: J_n = x^n j and
  /// Y_n = x^n y + (2/pi) (ln(x/2) J_n - n/x)   (DLMF 10.8.1).
  Polynomial<inner_degree> inner_j, inner_y;
};

/// [n] for n = 0 and 1.
const std::array<HankelFit, 2>& hankel_fits();

// Hankel functions of the first kind for arrays of real arguments, positive normal numbers of
// double, vectorised. Beyond 2^23 they take as long as the cos and sin of libm.

/// h[i] = H_0(x[i]), error below 1e-15 of |H_0|.
void hankel0(std::span<const double> x, std::span<Complex> h);

/// H_n(x_i) for n = 0 .. order at re[n * x.size() + i], im[n * x.size() + i], error below
/// (1 + n / 8) 1e-15 of |H_n|. Hence J_n alone is lost where |Y_n| is large; it is 0 where
/// |Y_n| > 1e8, which does not show in |H_n|. Y_n beyond the range of double is -inf.
void hankel_sets(std::span<const double> x, int order, double* re, double* im);

}  // namespace flatspeckle
