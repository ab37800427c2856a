#include "core/numbers/scaled_bessel.h"

#include <algorithm>
#include <utility>

#include "core/numbers/bessel.h"

namespace flatspeckle {

namespace {

// Up to here neither J_n underflows nor H_n overflows.
int plain_order(int order, double x) {
  return x < order ? std::max(1, static_cast<int>(x)) : order;
}

}  // namespace

std::vector<ScaledReal> scaled_bessel_j(int order, double x) {
  const int plain = plain_order(order, x);
  const auto first = bessel_j(plain, x);
  std::vector<ScaledReal> j(first.begin(), first.end());
  if (order <= plain) return {j.begin(), j.begin() + order + 1};
  const auto ratios = bessel_ratios(order, static_cast<long double>(x));
  for (int n = plain; n < order; ++n) j.push_back(ratios[n].real() * j[n]);
  return j;
}

std::vector<ScaledComplex> scaled_hankel(int order, double x) {
  const int plain = plain_order(order, x);
  const auto first = hankel(plain, x);
  std::vector<ScaledComplex> h(first.begin(), first.end());
  if (order <= plain) return {h.begin(), h.begin() + order + 1};
  const auto ratios = bessel_ratios(order, static_cast<long double>(x));
  ScaledReal j = h[plain].value().real();
  ScaledReal y_before = h[plain - 1].value().imag(), y = h[plain].value().imag();
  const long double two_over_x = 2 / static_cast<long double>(x);
  for (int n = plain; n < order; ++n) {
    y_before = std::exchange(y, n * two_over_x * y - y_before);
    j = ratios[n].real() * j;
    h.push_back(ExtendedComplex(0, 1) * y + j);
  }
  return h;
}

}  // namespace flatspeckle
