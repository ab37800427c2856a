#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Where the covariance of channels b <= a stands among the entries of a full_request().
inline std::size_t triangle_entry(std::size_t a, std::size_t b) {
  return a * (a + 1) / 2 + b;
}

/// The intensities of so many channels, of all covariances.
inline std::vector<Complex> diagonal(std::span<const Complex> triangle, std::size_t channels) {
  std::vector<Complex> found;
  for (std::size_t a = 0; a < channels; ++a) found.push_back(triangle[triangle_entry(a, a)]);
  return found;
}

}  // namespace flatspeckle
