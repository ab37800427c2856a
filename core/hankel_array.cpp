// Loops of straight-line arithmetic, which the compiler vectorises; no call of libm except beyond
// `phase_end`. Strict arithmetic (no -ffast-math): the reduction of the phase relies on it.
#include "core/hankel_array.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <math.h>  // j0l, j1l, y0l, y1l are no part of standard C++
#include <numbers>
#include <utility>

namespace flatspeckle {

namespace {

constexpr std::size_t chunk = 256;

// Below the border H_n is entire functions of x^2 and a logarithm, above it a smooth amplitude times
// e^{ix}.
constexpr double border = 3;

template <int degree>
using Polynomial = std::array<double, degree + 1>;

// Horner's rule written out: a loop inside a loop would not vectorise.
template <std::size_t size>
double evaluate(const std::array<double, size>& c, double t) {
  return [&]<std::size_t... m>(std::index_sequence<m...>) {
    double value = c[size - 1];
    ((value = value * t + c[size - 2 - m]), ...);
    return value;
  }(std::make_index_sequence<size - 1>());
}

// The interpolation in the Chebyshev nodes of t in [-1, 1], as powers of t. All coefficients here
// fall much faster than (1 + sqrt 2)^-m, so that powers are as stable as Chebyshev polynomials.
template <int degree, typename Function>
Polynomial<degree> interpolate(Function function) {
  constexpr int nodes = degree + 1;
  constexpr long double pi = std::numbers::pi_v<long double>;
  std::array<long double, nodes> values;
  for (int j = 0; j < nodes; ++j) values[j] = function(std::cos(pi * (j + 0.5L) / nodes));
  std::array<long double, nodes> sum{}, chebyshev{1}, before{};
  for (int m = 0; m < nodes; ++m) {
    long double weight = 0;
    for (int j = 0; j < nodes; ++j) weight += values[j] * std::cos(pi * m * (j + 0.5L) / nodes);
    weight *= (m == 0 ? 1.0L : 2.0L) / nodes;
    for (int p = 0; p <= m; ++p) sum[p] += weight * chebyshev[p];
    // T_{m+1} = 2 t T_m - T_{m-1}, T_1 = t T_0
    std::array<long double, nodes> next{};
    for (int p = 0; p < nodes; ++p)
      next[p] = (p == 0 ? 0 : (m == 0 ? 1 : 2) * chebyshev[p - 1]) - before[p];
    before = std::exchange(chebyshev, next);
  }
  Polynomial<degree> result;
  std::copy(sum.begin(), sum.end(), result.begin());
  return result;
}

// H_0 or H_1 in two pieces, fitted to extended precision. Degrees: the first neglected Chebyshev
// coefficient is below 1e-17 of |H|.
struct Fit {
  // sqrt(x) e^{-ix} H_n(x) on t = 2 border / x - 1
  Polynomial<21> outer_re, outer_im;
  // With t = 2 (x / border)^2 - 1 and p = x^n: J_n = p * j and
  // Y_n = p * y + (2/pi) (ln(x/2) J_n - n/x)   (DLMF 10.8.1)
  Polynomial<11> inner_j, inner_y;
};

Fit fit(int n) {
  const auto hankel = [n](long double x) -> ExtendedComplex {
    return n == 0 ? ExtendedComplex(::j0l(x), ::y0l(x)) : ExtendedComplex(::j1l(x), ::y1l(x));
  };
  const auto amplitude = [&](long double t) {
    const long double x = 2 * border / (1 + t);
    return product(hankel(x), std::polar(std::sqrt(x), -x));
  };
  const auto entire = [&](long double t) {
    const long double x = border * std::sqrt((1 + t) / 2);
    const ExtendedComplex h = hankel(x);
    const long double singular =
        2 / std::numbers::pi_v<long double> * (std::log(x / 2) * h.real() - n / x);
    return ExtendedComplex(h.real(), h.imag() - singular) / (n == 0 ? 1 : x);
  };
  return {interpolate<21>([&](long double t) { return amplitude(t).real(); }),
          interpolate<21>([&](long double t) { return amplitude(t).imag(); }),
          interpolate<11>([&](long double t) { return entire(t).real(); }),
          interpolate<11>([&](long double t) { return entire(t).imag(); })};
}

const Fit& fitted(int n) {
  static const std::array<Fit, 2> fits = {fit(0), fit(1)};
  return fits[n];
}

// (-1)^k t^k / (first (first + 1) ...): sin(r) / r and cos(r) in t = r^2
template <int degree>
constexpr Polynomial<degree> taylor(int first) {
  Polynomial<degree> c{1};
  for (int k = 1; k <= degree; ++k)
    c[k] = -c[k - 1] / ((first + 2 * k - 2.0) * (first + 2 * k - 1.0));
  return c;
}
constexpr Polynomial<10> sine_series = taylor<10>(2);
constexpr Polynomial<11> cosine_series = taylor<11>(1);

// atanh(f) / f in f^2
constexpr Polynomial<10> logarithm_series = [] {
  Polynomial<10> c;
  for (int k = 0; k <= 10; ++k) c[k] = 1.0 / (2 * k + 1);
  return c;
}();

// Arguments of one chunk above the border, and what all orders need of them.
struct Waves {
  alignas(64) double t[chunk], cosine[chunk], sine[chunk];  // cos(x) / sqrt(x), sin(x) / sqrt(x)
};

// pi in three parts, the first two short enough to be multiplied by 23 bits without rounding
constexpr double pi_high = 0x1.921fb54p+1;
constexpr double pi_middle = 0x1.10b4611p-29;
constexpr double pi_low = 0x1.4c4c6628b80dcp-59;
constexpr double phase_end = 0x1p23;

// Added, it leaves a double's integer part in its lowest bits.
constexpr double integer_bias = 0x1.8p52;

}  // namespace

}  // namespace flatspeckle
