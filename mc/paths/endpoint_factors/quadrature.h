#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/numbers/complex.h"

namespace flatspeckle::mc {

/// int_0^length exp(rate t) dt
inline Complex exponential_integral(Complex rate, double length) {
  const Complex z = rate * length;
  if (std::abs(z) < 1e-4) return length * (1.0 + z / 2.0 + z * z / 6.0);
  return (std::exp(z) - 1.0) / rate;
}

/// Eight-point Gauss-Legendre over panels of at most a radian or so.
template <typename F>
Complex integrate(F f, double from, double to, double radians) {
  static constexpr std::array<double, 4> node = {0.1834346424956498, 0.5255324099163290,
                                                 0.7966664774136267, 0.9602898564975363};
  static constexpr std::array<double, 4> weight = {0.3626837833783620, 0.3137066458778873,
                                                   0.2223810344533745, 0.1012285362903763};
  const auto panels = static_cast<std::size_t>(std::ceil(radians)) + 1;
  const double half = (to - from) / (2 * static_cast<double>(panels));
  Complex sum = 0;
  for (std::size_t p = 0; p < panels; ++p) {
    const double middle = from + (2 * static_cast<double>(p) + 1) * half;
    for (std::size_t i = 0; i < node.size(); ++i)
      sum += weight[i] * (f(middle - half * node[i]) + f(middle + half * node[i]));
  }
  return half * sum;
}

}  // namespace flatspeckle::mc
