#include "core/bessel.h"

#include <math.h>  // j0, j1, y0, y1 are POSIX

#include <algorithm>
#include <cassert>
#include <cmath>
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

Complex hankel0(double x) { return {::j0(x), ::y0(x)}; }

}  // namespace flatspeckle
