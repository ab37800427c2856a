#pragma once

#include <cmath>
#include <vector>

#include "wave_solver/clusters/cluster_equations.h"

namespace flatspeckle::bench {

/// Returns the disks of all copies of a cluster.
inline Placement copies(const Placement& cluster, const std::vector<wave::ClusterPlace>& places) {
  Placement all;
  for (const auto& [centre, angle] : places)
    for (const auto& [position, scatterer] : cluster) {
      const double c = std::cos(angle), s = std::sin(angle);
      all.push_back({centre + Vec{c * position.x + s * position.z, c * position.z - s * position.x},
                     scatterer});
    }
  return all;
}

/// Returns places for copies of a cluster in rows at this pitch, each rotated by a different angle.
inline std::vector<wave::ClusterPlace> rows_of_places(int rows, int columns, double pitch) {
  std::vector<wave::ClusterPlace> places;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      places.push_back({{pitch * column, pitch * row}, 0.7 * (row * columns + column)});
  return places;
}

}  // namespace flatspeckle::bench
