#include "core/numbers/hankel_array.h"

// The functions below contain loops without branches over a few arguments (lanes), which the
// compiler vectorises. libm is called only for x above phase_end. Do not compile with -ffast-math,
// which would break the reduction of the phase and the result -inf.

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <math.h>  // j0l, j1l, y0l, y1l are not part of standard C++
#include <numbers>
#include <utility>

#include "core/contract.h"
#include "core/numbers/complex.h"

namespace flatspeckle {

namespace {

constexpr long double pi = std::numbers::pi_v<long double>;

// Returns the polynomial that interpolates the function at the Chebyshev nodes of [-1, 1]. Powers
// of t are as stable as Chebyshev polynomials if the Chebyshev coefficients fall faster than (1 +
// sqrt 2)^-m, as they do here.
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

constexpr std::size_t lanes = 16;

struct Lanes {
  alignas(64) double at[lanes];
};

struct Hankel {
  Lanes re, im;
};

using Limits = std::numeric_limits<double>;
using Fits = std::array<HankelFit, 2>;

// Evaluates c[last] u^k + c[last - 2] u^(k-1) + ... by Horner's rule. The loop is unrolled by
// templates, because loops that contain loops or calls are not vectorised.
template <std::size_t last, std::size_t size, std::size_t... m>
[[gnu::always_inline]] inline double every_second(const std::array<double, size>& c, double u,
                                                  std::index_sequence<m...>) {
  double value = c[last];
  ((value = value * u + c[last - 2 - 2 * m]), ...);
  return value;
}

// Evaluates the polynomial c at t. Even and odd powers are summed separately, because two short
// dependency chains are faster than a long one.
template <std::size_t size>
[[gnu::always_inline]] inline double evaluate(const std::array<double, size>& c, double t) {
  constexpr std::size_t odd = size - 1 - size % 2, even = size - 2 + size % 2;
  return every_second<even>(c, t * t, std::make_index_sequence<even / 2>()) +
         t * every_second<odd>(c, t * t, std::make_index_sequence<odd / 2>());
}

// Returns the Taylor coefficients, in powers of r^2, of cos(r) if first = 1, and of sin(r) / r if
// first = 2.
template <int degree>
constexpr Polynomial<degree> taylor(int first) {
  Polynomial<degree> c{1};
  for (int k = 1; k <= degree; ++k)
    c[k] = -c[k - 1] / ((first + 2 * k - 2.0) * (first + 2 * k - 1.0));
  return c;
}
// Taylor series that are accurate to rounding for |r| <= pi/2.
constexpr auto cosine_series = taylor<11>(1);
constexpr auto sine_series = taylor<10>(2);

// Taylor series of atanh(f) / f in powers of f^2, accurate to rounding for f^2 <= 0.03.
constexpr auto atanh_series = [] {
  Polynomial<10> c{};
  for (int k = 0; k <= 10; ++k) c[k] = 1.0 / (2 * k + 1);
  return c;
}();

// pi as a sum of three parts. The product of an integer below 2^23 with the first or second part is
// exact.
constexpr double pi_high = 0x1.921fb54p+1;
constexpr double pi_middle = 0x1.10b4611p-29;
constexpr double pi_low = 0x1.4c4c6628b80dcp-58;
constexpr double phase_end = 0x1p23;

// If this constant is added to a number, the lowest bits of the sum contain the number rounded to
// an integer.
constexpr double integer_bias = 0x1.8p52;

// Quantities for x above HankelFit::border that H_0 and H_1 have in common: the variable t of the
// fit, and the real and imaginary parts of e^{ix} / sqrt(x).
struct Outer {
  Lanes t, cosine, sine;
};

void prepare(const double* x, double greatest, Outer& outer) {
#pragma omp simd
  for (std::size_t i = 0; i < lanes; ++i) {
    const double inverse = 1 / x[i];
    outer.t.at[i] = std::min(2 * HankelFit::border * inverse - 1, 1.0);
    const double biased = x[i] * std::numbers::inv_pi + integer_bias;
    const double half_turns = biased - integer_bias;
    const double r = ((x[i] - half_turns * pi_high) - half_turns * pi_middle) - half_turns * pi_low;
    const std::uint64_t odd = std::bit_cast<std::uint64_t>(biased) << 63;
    const double size =
        std::bit_cast<double>(std::bit_cast<std::uint64_t>(std::sqrt(inverse)) ^ odd);
    outer.cosine.at[i] = size * evaluate(cosine_series, r * r);
    outer.sine.at[i] = size * (r * evaluate(sine_series, r * r));
  }
  if (greatest < phase_end) return;
  for (std::size_t i = 0; i < lanes; ++i) {
    if (x[i] < phase_end) continue;
    outer.cosine.at[i] = std::cos(x[i]) / std::sqrt(x[i]);
    outer.sine.at[i] = std::sin(x[i]) / std::sqrt(x[i]);
  }
}

void evaluate_outer(const HankelFit& fit, const Outer& outer, Hankel& h) {
#pragma omp simd
  for (std::size_t i = 0; i < lanes; ++i) {
    const double a = evaluate(fit.outer_re, outer.t.at[i]);
    const double b = evaluate(fit.outer_im, outer.t.at[i]);
    h.re.at[i] = a * outer.cosine.at[i] - b * outer.sine.at[i];
    h.im.at[i] = a * outer.sine.at[i] + b * outer.cosine.at[i];
  }
}

// Computes (2/pi) ln(x/2) from x/2 = 2^e m with m in [1/sqrt 2, sqrt 2), and ln m = 2
// atanh((m-1)/(m+1)).
void scaled_logarithms(const double* x, Lanes& out) {
  constexpr auto least = std::bit_cast<std::uint64_t>(std::numbers::sqrt2 / 2);
  constexpr auto one = std::bit_cast<std::uint64_t>(1.0);
  constexpr auto bias = std::bit_cast<std::uint64_t>(integer_bias);
#pragma omp simd
  for (std::size_t i = 0; i < lanes; ++i) {
    const std::uint64_t shifted = std::bit_cast<std::uint64_t>(x[i]) + (one - least);
    const double e = std::bit_cast<double>(bias + (shifted >> 52)) - (integer_bias + 1024);
    const double m = std::bit_cast<double>((shifted & 0xfffffffffffffu) + least);
    const double f = (m - 1) / (m + 1);
    const double logarithm = e * std::numbers::ln2 + 2 * f * evaluate(atanh_series, f * f);
    out.at[i] = 2 / std::numbers::pi * logarithm;
  }
}

template <int order>
void evaluate_inner(const HankelFit& fit, const double* x, const Lanes& logarithm, Hankel& h) {
#pragma omp simd
  for (std::size_t i = 0; i < lanes; ++i) {
    const double power = order == 0 ? 1 : x[i];
    const double ratio = std::min(x[i] / HankelFit::border, 1.0), t = 2 * ratio * ratio - 1;
    const double j = power * evaluate(fit.inner_j, t);
    double y = power * evaluate(fit.inner_y, t) + logarithm.at[i] * j;
    if constexpr (order == 1) y -= 2 / std::numbers::pi / x[i];
    h.re.at[i] = j;
    h.im.at[i] = y;
  }
}

// Replaces H_n by the result of the inner fit for arguments below the border. This is a loop of its
// own, because in the loops that compute the fits the compiler would make it a branch.
void replace_inside(const double* x, const Hankel& inner, Hankel& h) {
#pragma omp simd
  for (std::size_t i = 0; i < lanes; ++i) {
    const bool inside = x[i] < HankelFit::border;
    h.re.at[i] = inside ? inner.re.at[i] : h.re.at[i];
    h.im.at[i] = inside ? inner.im.at[i] : h.im.at[i];
  }
}

// Computes H_0 and, if orders = 2, H_1. A piece of the fit (below or above the border) is skipped
// if no argument is in it.
template <int orders>
void seeds(const Fits& fits, const double* x, Hankel (&h)[orders]) {
  double least = x[0], greatest = least;
#pragma omp simd reduction(min : least) reduction(max : greatest)
  for (std::size_t i = 0; i < lanes; ++i) {
    least = std::min(least, x[i]);
    greatest = std::max(greatest, x[i]);
  }
  assert(least >= Limits::min() && greatest <= Limits::max());
  if (greatest >= HankelFit::border) {
    Outer outer;
    prepare(x, greatest, outer);
    for (int n = 0; n < orders; ++n) evaluate_outer(fits[n], outer, h[n]);
  }
  if (least >= HankelFit::border) return;
  Lanes logarithm;
  scaled_logarithms(x, logarithm);
  Hankel inner;
  evaluate_inner<0>(fits[0], x, logarithm, inner);
  replace_inside(x, inner, h[0]);
  if constexpr (orders == 1) return;
  evaluate_inner<1>(fits[1], x, logarithm, inner);
  replace_inside(x, inner, h[orders - 1]);
}

// Replaces `before`, which contains H_{n-1}, by H_{n+1} = (2n/x) H_n - H_{n-1}. In this upward
// recurrence, the error remains small relative to |H_n|. Y_{n-1} is bounded, so that Y_{n+1}
// becomes -inf instead of inf - inf.
void recur(int n, const double* x, const Hankel& h, Hankel& before) {
  // If Y_n is below this value, J_n is set to 0. It is negligible in |H_n| then, because J_n |Y_n|
  // is about 1 / (pi n).
  constexpr double hidden = -1e8;
#pragma omp simd
  for (std::size_t i = 0; i < lanes; ++i) {
    const double factor = 2 * n / x[i];
    const double j = factor * h.re.at[i] - before.re.at[i];
    const double y = factor * h.im.at[i] - std::max(before.im.at[i], Limits::lowest());
    before.re.at[i] = y < hidden ? 0 : j;
    before.im.at[i] = y;
  }
}

void store(const Lanes& values, std::size_t n, double* out) {
  if (n == lanes)
    std::copy_n(values.at, lanes, out);
  else
    std::copy_n(values.at, n, out);
}

void store(const Hankel& h, std::size_t n, Complex* out) {
  if (n < lanes) {
    Complex values[lanes];
    store(h, lanes, values);
    std::copy_n(values, n, out);
    return;
  }
  for (std::size_t i = 0; i < lanes; ++i) out[i] = {h.re.at[i], h.im.at[i]};
}

// Calls body(arguments, index of the first argument, number of arguments) for groups of `lanes`
// arguments. The last group is filled up with copies of its first argument.
template <typename Body>
void for_groups(std::span<const double> x, Body body) {
  std::size_t first = 0;
  for (; first + lanes <= x.size(); first += lanes) body(x.data() + first, first, lanes);
  if (first == x.size()) return;
  Lanes rest;
  std::fill(rest.at, rest.at + lanes, x[first]);
  std::copy(x.begin() + first, x.end(), rest.at);
  body(rest.at, first, x.size() - first);
}

}  // namespace

const std::array<HankelFit, 2>& hankel_fits() {
  static const std::array<HankelFit, 2> fits = {fit(0), fit(1)};
  return fits;
}

void hankel0(std::span<const double> x, std::span<Complex> h) {
  FS_EXPECT(x.size() == h.size());
  const Fits& fits = hankel_fits();
  for_groups(x, [&](const double* arguments, std::size_t first, std::size_t n) {
    Hankel values[1];
    seeds(fits, arguments, values);
    store(values[0], n, h.data() + first);
  });
}

void hankel_sets(std::span<const double> x, int order, double* re, double* im) {
  FS_EXPECT(order >= 0);
  const Fits& fits = hankel_fits();
  for_groups(x, [&](const double* arguments, std::size_t first, std::size_t n) {
    Hankel values[2];
    seeds(fits, arguments, values);
    for (int m = 0; m <= order; ++m) {
      if (m > 1) recur(m - 1, arguments, values[(m - 1) % 2], values[m % 2]);
      store(values[m % 2].re, n, re + m * x.size() + first);
      store(values[m % 2].im, n, im + m * x.size() + first);
    }
  });
}

}  // namespace flatspeckle
