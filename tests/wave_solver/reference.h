#pragma once

#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/placement/placement.h"

namespace flatspeckle::wave {

inline constexpr double two_pi = 2 * std::numbers::pi;

/// Returns the path of data/reference/NAME.
std::string reference_path(const std::string& name);

/// Reads the placement of data/reference/FOLDER with all scatterers of one kind, named as in the
/// files: D, N, TM15, TE15, TM15abs, TE15abs.
Placement reference_placement(const std::string& folder, const std::string& kind);
Scatterer reference_scatterer(const std::string& kind);

inline double relative_distance(std::span<const Complex> a, std::span<const Complex> b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    difference += std::norm(a[i] - b[i]);
    size += std::norm(b[i]);
  }
  return std::sqrt(difference / size);
}

}  // namespace flatspeckle::wave
