#include "core/bessel.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <math.h>  // j0, j1, y0, y1 are POSIX
#include <numbers>
#include <utility>

namespace flatspeckle {

namespace {

// Beyond the turning point n = |z| the unwanted solution falls by exp(-1.89 d^1.5 / sqrt|z|) over d
// orders; this start makes it 1e-20.
int downward_start(int order, long double size) {
  const double turning = std::max(static_cast<double>(order), static_cast<double>(size));
  return static_cast<int>(std::ceil(turning + 9 * std::cbrt(turning))) + 12;
}

// r_{n-1} = 1 / (2n/z - r_n), calling store(n, r_n) for first <= n <= last.
template <typename Number, typename Store>
void ratios_downward(int first, int last, Number z, Store store) {
  const int start = downward_start(last, std::abs(z));
  const Number two_over_z = 2.0L / z;
  Number ratio = 1.0L / (static_cast<long double>(start + 1) * two_over_z);
  for (int n = start - 1; n >= first; --n) {
    Number inverse = static_cast<long double>(n + 1) * two_over_z - ratio;
    if (inverse == Number(0)) inverse = 1e-30L;  // a zero of J_n: any huge ratio will do
    ratio = 1.0L / inverse;
    if (n <= last) store(n, ratio);
  }
}

// Below this H_0 is summed as a power series, whose terms do not exceed 1; above it is a smooth
// amplitude times e^{ix}.
constexpr double series_end = 2;

// With y = x^2/4: J_0 = sum (-y)^k / k!^2 and
// Y_0 = (2/pi) [(ln(x/2) + gamma) J_0 - sum (-y)^k h_k / k!^2], h_k = 1 + 1/2 + .. + 1/k
// (DLMF 10.8.2).
Complex hankel0_series(double x) {
  constexpr int terms = 13;
  const double minus_y = -x * x / 4;
  double term = 1, harmonic = 0, j = 1, rest = 0;
  for (int k = 1; k < terms; ++k) {
    term *= minus_y / (k * k);
    harmonic += 1.0 / k;
    j += term;
    rest += term * harmonic;
  }
  const double logarithm = std::log(x / 2) + std::numbers::egamma;
  return {j, 2 / std::numbers::pi * (logarithm * j - rest)};
}

// sqrt(x) e^{-ix} H_0(x) as Chebyshev series in pieces of equal length in 1/x.
class Amplitude {
 public:
  Amplitude() {
    for (int piece = 0; piece < pieces; ++piece) fit(piece);
  }

  Complex hankel0(double x) const {
    const double place = pieces * series_end / x;
    const int piece = std::min(static_cast<int>(place), pieces - 1);
    const double twice_t = 4 * (place - piece) - 2;
    const auto& c = coefficients_[piece];
    double re = c[degree][0], im = c[degree][1], re_before = 0, im_before = 0;
    for (int m = degree - 1; m > 0; --m) {  // Clenshaw
      re_before = std::exchange(re, c[m][0] + twice_t * re - re_before);
      im_before = std::exchange(im, c[m][1] + twice_t * im - im_before);
    }
    re = c[0][0] + twice_t / 2 * re - re_before;
    im = c[0][1] + twice_t / 2 * im - im_before;
    const double size = 1 / std::sqrt(x), cosine = std::cos(x) * size, sine = std::sin(x) * size;
    return {re * cosine - im * sine, re * sine + im * cosine};
  }

 private:
  static constexpr int pieces = 32, degree = 6;

  void fit(int piece) {
    constexpr int nodes = degree + 1;
    auto& c = coefficients_[piece];
    for (int node = 0; node < nodes; ++node) {
      const long double angle = std::numbers::pi_v<long double> * (node + 0.5L) / nodes;
      const long double x = pieces * series_end / (piece + (1 + std::cos(angle)) / 2);
      const ExtendedComplex value = product({::j0l(x), ::y0l(x)}, std::polar(std::sqrt(x), -x));
      for (int m = 0; m < nodes; ++m) {
        const long double weight = (m == 0 ? 1.0L : 2.0L) / nodes * std::cos(m * angle);
        c[m][0] += static_cast<double>(weight * value.real());
        c[m][1] += static_cast<double>(weight * value.imag());
      }
    }
  }

  std::array<std::array<std::array<double, 2>, degree + 1>, pieces> coefficients_{};
};

const Amplitude amplitude;

}  // namespace

std::vector<ExtendedComplex> bessel_ratios(int order, ExtendedComplex z) {
  std::vector<ExtendedComplex> ratios(order + 1);
  ratios_downward(0, order, z, [&](int n, ExtendedComplex ratio) { ratios[n] = ratio; });
  return ratios;
}

std::vector<long double> bessel_j(int order, double x) {
  assert(x > 0);
  std::vector<long double> j(order + 2);
  ratios_downward(0, order, static_cast<long double>(x),
                  [&](int n, long double ratio) { j[n + 1] = ratio; });
  // Anchored at whichever of J_0 and J_1 is not close to a zero.
  const double j0 = ::j0(x), j1 = ::j1(x);
  j[0] = std::abs(j0) >= std::abs(j1) ? j0 : j1 / j[1];
  for (int n = 0; n <= order; ++n) j[n + 1] *= j[n];
  j.pop_back();
  return j;
}

void hankel(double x, std::span<ExtendedComplex> h) {
  assert(x > 0);
  if (h.empty()) return;
  const int order = static_cast<int>(h.size()) - 1;
  h[0] = {::j0(x), ::y0(x)};
  if (order == 0) return;
  const int turning = x < order ? static_cast<int>(x) : order;
  long double j_before = h[0].real(), j = ::j1(x), y_before = h[0].imag(), y = ::y1(x);
  const long double two_over_x = 2 / static_cast<long double>(x);
  for (int n = 1; n <= order; ++n) {
    h[n] = {j, y};
    const long double factor = n * two_over_x;
    y_before = std::exchange(y, factor * y - y_before);
    if (n < turning) j_before = std::exchange(j, factor * j - j_before);
  }
  if (turning == order) return;
  // J_n grows unstable upwards beyond n = x, where it has no zeros: ratios take over.
  ratios_downward(turning, order - 1, static_cast<long double>(x),
                  [&](int n, long double ratio) { h[n + 1].real(ratio); });
  for (int n = turning; n < order; ++n) h[n + 1].real(h[n + 1].real() * h[n].real());
}

std::vector<ExtendedComplex> hankel(int order, double x) {
  std::vector<ExtendedComplex> h(order + 1);
  hankel(x, h);
  return h;
}

Complex hankel0(double x) {
  assert(x > 0);
  return x < series_end ? hankel0_series(x) : amplitude.hankel0(x);
}

}  // namespace flatspeckle
