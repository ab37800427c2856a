#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle::mc {

/// Derivative of what f makes of entries, along that of the entries, by a central difference.
template <typename F>
std::vector<Complex> directional_slope(const F& f, std::span<const Complex> entries,
                                       std::span<const Complex> along) {
  const auto largest = [](std::span<const Complex> values) {
    double most = 0;
    for (const Complex value : values) most = std::max(most, std::abs(value));
    return most;
  };
  const bool still = largest(along) == 0;
  const double step = still ? 1 : 1e-6 * largest(entries) / largest(along);
  const auto moved = [&](double by) {
    std::vector<Complex> values(entries.begin(), entries.end());
    for (std::size_t e = 0; e < values.size(); ++e) values[e] += by * along[e];
    return f(values);
  };
  std::vector<Complex> slope = moved(step);
  const std::vector<Complex> below = moved(-step);
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - below[i]) / (2 * step);
  return slope;
}

}  // namespace flatspeckle::mc
