#pragma once

#include <array>

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

}  // namespace flatspeckle
