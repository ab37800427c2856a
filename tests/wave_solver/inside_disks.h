#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "wave_solver/maps/field_map.h"

namespace flatspeckle::wave {

/// Of fields of clusters of disks, over the tolerance.
struct WorstError {
  double inside = 0, outside = 0;

  void add(const WorstError& other, double tolerance) {
    inside = std::max(inside, other.inside / tolerance);
    outside = std::max(outside, other.outside / tolerance);
  }
};

/// What a cluster may have.
struct ClusterSize {
  int disks;
  std::size_t unknowns;  ///< at a tolerance of 1e-12
};

/// Of so many random clusters from number `first` on, of those that are small enough, against an
/// oracle, by tolerance. Two disks or more, index to 8, gaps from 1e-4 of the smaller radius on.
std::vector<WorstError> worst_errors(int first, int clusters, const ClusterSize& most,
                                     const std::vector<double>& tolerances);

/// Checks the same of a disk of k a = 1 and one `ratio` times as large, where they face each other
/// across a gap given in radii of that one. kind: as reference_scatterer() has it.
void check_gap(const std::string& kind, double ratio, double gap,
               const std::vector<double>& tolerances);

/// Of a map of penetrable disks in a plane wave, against an oracle: |u - exact|, the largest of
/// every stride-th pixel.
double worst_on_map(const Placement& placement, double angle, const MapGrid& grid, double tolerance,
                    std::size_t stride);

}  // namespace flatspeckle::wave
