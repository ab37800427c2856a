#include "core/numbers/bessel.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <math.h>  // j0, j1, y0, y1, j0l, j1l are not part of standard C++
#include <utility>

namespace flatspeckle {

namespace {

// Returns the highest order, at most `order`, up to which neither J_n(x) underflows nor H_n(x)
// overflows.
int plain_order(int order, double x) {
  return x < order ? std::max(1, static_cast<int>(x)) : order;
}

// Returns the order at which the downward recurrence starts. Over the d orders above the turning
// point n = |z|, the error caused by the arbitrary start falls by exp(-1.89 d^1.5 / sqrt|z|); from
// this order it falls by 1e-20.
int downward_start(int order, long double size) {
  const double turning = std::max(static_cast<double>(order), static_cast<double>(size));
  return static_cast<int>(std::ceil(turning + 9 * std::cbrt(turning))) + 12;
}

// Returns what is added to an order in the recurrences, because j_n is J_{n+1/2} times a factor.
long double shift_of(Radial kind) {
  return kind == Radial::spherical ? 0.5L : 0.0L;
}

// Evaluates r_{n-1} = 1 / (2n/z - r_n) downwards and calls store(n, r_n) for first <= n <= last.
template <typename Number, typename Store>
void ratios_downward(int first, int last, Number z, Radial kind, Store store) {
  const long double shift = shift_of(kind);
  const int start = downward_start(last, std::abs(z));
  const Number two_over_z = 2.0L / z;
  Number ratio = 1.0L / ((static_cast<long double>(start + 1) + shift) * two_over_z);
  for (int n = start - 1; n >= first; --n) {
    Number inverse = (static_cast<long double>(n + 1) + shift) * two_over_z - ratio;
    if (inverse == Number(0)) inverse = 1e-30L;  // at a zero of J_n, any huge ratio is correct
    ratio = 1.0L / inverse;
    if (n <= last) store(n, ratio);
  }
}

// Computes j_0(x) and j_1(x). For small x the closed form of j_1 would cancel.
void start_spherical_j(long double x, long double& first, long double& second) {
  first = std::sin(x) / x;
  second = (first - std::cos(x)) / x;
  if (x < 1)
    ratios_downward(0, 0, x, Radial::spherical,
                    [&](int, long double ratio) { second = ratio * first; });
}

// Computes J_2 .. J_order from J_0 and J_1, with J_n at j[n * stride].
void continue_j(double x, int order, Radial kind, int stride, long double* j) {
  const long double two_over_x = 2 / static_cast<long double>(x), shift = shift_of(kind);
  const int turning = x < order ? std::max(static_cast<int>(x), 1) : order;
  long double before = j[0], value = j[stride];
  for (int n = 1; n < turning; ++n) {
    before = std::exchange(value, (n + shift) * two_over_x * value - before);
    j[(n + 1) * stride] = value;
  }
  if (turning >= order) return;
  // For n > x the upward recurrence is unstable. J_n has no zeros there, so that ratios J_{n+1} /
  // J_n are used instead.
  ratios_downward(turning, order - 1, static_cast<long double>(x), kind,
                  [&](int n, long double ratio) { j[(n + 1) * stride] = ratio; });
  for (int n = turning; n < order; ++n) j[(n + 1) * stride] *= j[n * stride];
}

}  // namespace

std::vector<ScaledReal> scaled_bessel_j(int order, double x, Radial kind) {
  const int plain = plain_order(order, x);
  const auto first = bessel_j(plain, x, kind);
  std::vector<ScaledReal> j(first.begin(), first.end());
  if (order <= plain) return {j.begin(), j.begin() + order + 1};
  const auto ratios = bessel_ratios(order, static_cast<long double>(x), kind);
  for (int n = plain; n < order; ++n) j.push_back(ratios[n].real() * j[n]);
  return j;
}

std::vector<ScaledComplex> scaled_hankel(int order, double x, Radial kind) {
  const int plain = plain_order(order, x);
  const auto first = hankel(plain, x, kind);
  std::vector<ScaledComplex> h(first.begin(), first.end());
  if (order <= plain) return {h.begin(), h.begin() + order + 1};
  const auto ratios = bessel_ratios(order, static_cast<long double>(x), kind);
  ScaledReal j = h[plain].value().real();
  ScaledReal y_before = h[plain - 1].value().imag(), y = h[plain].value().imag();
  const long double two_over_x = 2 / static_cast<long double>(x), shift = shift_of(kind);
  for (int n = plain; n < order; ++n) {
    y_before = std::exchange(y, (n + shift) * two_over_x * y - y_before);
    j = ratios[n].real() * j;
    h.push_back(ExtendedComplex(0, 1) * y + j);
  }
  return h;
}

std::vector<ExtendedComplex> bessel_ratios(int order, ExtendedComplex z, Radial kind) {
  std::vector<ExtendedComplex> ratios(order + 1);
  ratios_downward(0, order, z, kind, [&](int n, ExtendedComplex ratio) { ratios[n] = ratio; });
  return ratios;
}

std::vector<long double> bessel_j(int order, double x, Radial kind) {
  assert(x > 0);
  std::vector<long double> j(std::max(order, 1) + 1);
  if (kind == Radial::spherical)
    start_spherical_j(x, j[0], j[1]);
  else
    j[0] = ::j0l(x), j[1] = ::j1l(x);
  continue_j(x, order, kind, 1, j.data());
  j.resize(order + 1);
  return j;
}

void hankel(double x, std::span<ExtendedComplex> h, Radial kind) {
  assert(x > 0);
  if (h.empty()) return;
  const int order = static_cast<int>(h.size()) - 1;
  ExtendedComplex second;
  if (kind == Radial::spherical) {
    const long double z = x;
    long double j0, j1;
    start_spherical_j(z, j0, j1);
    h[0] = {j0, -std::cos(z) / z};
    second = {j1, -(std::cos(z) / z + std::sin(z)) / z};
  } else {
    h[0] = {::j0(x), ::y0(x)};
    if (order > 0) second = {::j1(x), ::y1(x)};
  }
  if (order == 0) return;
  h[1] = second;
  continue_j(x, order, kind, 2, reinterpret_cast<long double*>(h.data()));
  const long double two_over_x = 2 / static_cast<long double>(x), shift = shift_of(kind);
  long double y_before = h[0].imag(), y = h[1].imag();
  for (int n = 1; n < order; ++n) {
    y_before = std::exchange(y, (n + shift) * two_over_x * y - y_before);
    h[n + 1].imag(y);
  }
}

std::vector<ExtendedComplex> hankel(int order, double x, Radial kind) {
  std::vector<ExtendedComplex> h(order + 1);
  hankel(x, h, kind);
  return h;
}

}  // namespace flatspeckle
