#pragma once

#include <array>
#include <span>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Coefficients c of the polynomial sum_m c[m] t^m.
template <int degree>
using Polynomial = std::array<double, degree + 1>;

/// Polynomial fit of H_0 or H_1, with one piece above and one below x = border. It is computed at
/// the first call from libm's long double functions. The first omitted Chebyshev coefficient is
/// below 1e-17 of |H_n|.
struct HankelFit {
  static constexpr double border = 4;
  static constexpr int outer_degree = 19, inner_degree = 12;

  /// Fit for x >= border: real and imaginary parts of sqrt(x) e^{-ix} H_n(x) as polynomials in t =
  /// 2 border / x - 1.
  Polynomial<outer_degree> outer_re, outer_im;
  /// Fit for x < border: polynomials j and y in t = 2 (x / border)^2 - 1, from which J_n = x^n j
  /// and Y_n = x^n y + (2/pi) (ln(x/2) J_n - n/x) (DLMF 10.8.1).
  Polynomial<inner_degree> inner_j, inner_y;
};

/// Returns the fits of H_0 and H_1.
const std::array<HankelFit, 2>& hankel_fits();

// Vectorised Hankel functions of the first kind for arrays of positive, normal (not subnormal)
// doubles. Above x = 2^23, cos and sin of libm are used, which are slower.

/// Computes h[i] = H_0(x[i]) with an error below 1e-15 |H_0|.
void hankel0(std::span<const double> x, std::span<Complex> h);

/// Computes H_n(x[i]) for n = 0 .. order, and stores the real part J_n in re[n * x.size() + i] and
/// the imaginary part Y_n in im[n * x.size() + i]. The error is below (1 + n / 8) 1e-15 |H_n|. J_n
/// alone is therefore inaccurate if |Y_n| is large; it is set to 0 if |Y_n| > 1e8. Y_n beyond the
/// range of double is -inf.
void hankel_sets(std::span<const double> x, int order, double* re, double* im);

}  // namespace flatspeckle
