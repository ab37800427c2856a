#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "wave_solver/maps/field_map.h"

namespace flatspeckle::wave {

/// Largest errors of fields inside and outside disks, in units of the tolerance.
struct WorstError {
  double inside = 0, outside = 0;

  void add(const WorstError& other, double tolerance) {
    inside = std::max(inside, other.inside / tolerance);
    outside = std::max(outside, other.outside / tolerance);
  }
};

/// Limits of the size of a cluster.
struct ClusterSize {
  int disks;
  std::size_t unknowns;  ///< at a tolerance of 1e-12
};

/// Returns the largest errors over random clusters compared with an oracle, for each tolerance: the
/// given number of clusters within the limits, from number `first` on. Clusters have at least two
/// disks, indices up to 8, and gaps of at least 1e-4 of the smaller radius.
std::vector<WorstError> worst_errors(int first, int clusters, const ClusterSize& most,
                                     const std::vector<double>& tolerances);

/// Checks fields of a disk of k a = 1 and one `ratio` times as large near the gap between them,
/// which is given in radii of the second. kind: as in reference_scatterer().
void check_gap(const std::string& kind, double ratio, double gap,
               const std::vector<double>& tolerances);

/// Returns the largest |u - exact| over every stride-th pixel of a map of penetrable disks in a
/// plane wave, compared with an oracle.
double worst_on_map(const Placement& placement, double angle, const MapGrid& grid, double tolerance,
                    std::size_t stride);

}  // namespace flatspeckle::wave
