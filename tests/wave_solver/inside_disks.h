#pragma once

#include <algorithm>
#include <vector>

namespace flatspeckle::wave {

/// Of fields of clusters of disks, over the tolerance.
struct WorstError {
  double inside = 0, outside = 0;

  void add(const WorstError& other, double tolerance) {
    inside = std::max(inside, other.inside / tolerance);
    outside = std::max(outside, other.outside / tolerance);
  }
};

/// Of so many random clusters from `first` on, against an oracle, by tolerance.
std::vector<WorstError> worst_errors(int first, int clusters, int most_disks,
                                     const std::vector<double>& tolerances);

}  // namespace flatspeckle::wave
