#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "core/numbers/complex.h"

namespace flatspeckle::mc::tests {

/// Compares the derivatives in `found` (values, then derivatives) with sixth-order differences of
/// values(step). `scale` is the step over which the values change.
template <typename Values>
void check_sixth_order(const std::vector<Complex>& found, double scale, const Values& values) {
  const double step = 0.02 * scale;
  std::vector<std::vector<Complex>> near;
  for (const double steps : {-3, -2, -1, 1, 2, 3}) near.push_back(values(steps * step));
  const std::size_t entries = found.size() / 2;
  for (std::size_t e = 0; e < entries; ++e) {
    CAPTURE(e);
    const Complex expected = (near[5][e] - near[0][e] - 9.0 * (near[4][e] - near[1][e]) +
                              45.0 * (near[3][e] - near[2][e])) /
                             (60 * step);
    CHECK(std::abs(found[entries + e] - expected) <
          1e-7 * std::max(std::abs(expected), std::abs(found[e]) / scale));
  }
}

}  // namespace flatspeckle::mc::tests
