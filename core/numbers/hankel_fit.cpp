#include "core/numbers/hankel_fit.h"

#include <cmath>
#include <math.h>  // j0l, j1l, y0l, y1l are no part of standard C++
#include <numbers>
#include <utility>

#include "core/numbers/complex.h"

namespace flatspeckle {

namespace {

constexpr long double pi = std::numbers::pi_v<long double>;

// Interpolates in the Chebyshev nodes of [-1, 1]. As powers of t this is as stable as in Chebyshev
// polynomials where their coefficients fall faster than (1 + sqrt 2)^-m, as all do here.
template <int degree, typename Function>
Polynomial<degree> interpolate(Function function) {
  constexpr int nodes = degree + 1;
  using Row = std::array<long double, nodes>;
  Row values, powers{}, chebyshev{1}, before{};
  for (int j = 0; j < nodes; ++j) values[j] = function(std::cos(pi * (j + 0.5L) / nodes));
  for (int m = 0; m < nodes; ++m) {
    long double coefficient = 0;
    for (int j = 0; j < nodes; ++j)
      coefficient += (m == 0 ? 1 : 2) * values[j] * std::cos(pi * m * (j + 0.5L) / nodes) / nodes;
    Row next{};  // T_1 = t T_0, T_{m+1} = 2 t T_m - T_{m-1}
    for (int p = 0; p < nodes; ++p) {
      powers[p] += coefficient * chebyshev[p];
      next[p] = (p == 0 ? 0 : (m == 0 ? 1 : 2) * chebyshev[p - 1]) - before[p];
    }
    before = std::exchange(chebyshev, next);
  }
  Polynomial<degree> result;
  for (int p = 0; p < nodes; ++p) result[p] = static_cast<double>(powers[p]);
  return result;
}

ExtendedComplex hankel(int n, long double x) {
  return n == 0 ? ExtendedComplex(::j0l(x), ::y0l(x)) : ExtendedComplex(::j1l(x), ::y1l(x));
}

ExtendedComplex amplitude(int n, long double t) {
  const long double x = 2 * HankelFit::border / (1 + t);
  return product(hankel(n, x), std::polar(std::sqrt(x), -x));
}

ExtendedComplex regular_parts(int n, long double t) {
  const long double x = HankelFit::border * std::sqrt((1 + t) / 2);
  const ExtendedComplex h = hankel(n, x);
  const long double singular = 2 / pi * (std::log(x / 2) * h.real() - n / x);
  return ExtendedComplex(h.real(), h.imag() - singular) / (n == 0 ? 1.0L : x);
}

HankelFit fit(int n) {
  constexpr int outer = HankelFit::outer_degree, inner = HankelFit::inner_degree;
  return {interpolate<outer>([n](long double t) { return amplitude(n, t).real(); }),
          interpolate<outer>([n](long double t) { return amplitude(n, t).imag(); }),
          interpolate<inner>([n](long double t) { return regular_parts(n, t).real(); }),
          interpolate<inner>([n](long double t) { return regular_parts(n, t).imag(); })};
}

}  // namespace

const std::array<HankelFit, 2>& hankel_fits() {
  static const std::array<HankelFit, 2> fits = {fit(0), fit(1)};
  return fits;
}

}  // namespace flatspeckle
