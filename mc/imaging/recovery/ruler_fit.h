#pragma once

#include <optional>
#include <vector>

#include "mc/imaging/recovery/sparse_search.h"

namespace flatspeckle::mc {

/// What is expected of a pair of points of mean brightness at each lag of the peaks.
std::vector<double> expected_heights(const PairPeaks& peaks, const SparseTask& task);

/// Points at these lags with the brightness that is most likely.
struct RulerFit {
  std::vector<double> marks, brightness;  ///< marks in steps
  double explained = 0;
  double gain = 0;  ///< twice the logarithm of the likelihood, over that of nothing
};
/// apart: with places about them that are most likely too, of which points and distances keep so
/// many steps from each other.
RulerFit fitted_ruler(const PairPeaks& peaks, const std::vector<double>& expected,
                      std::vector<double> marks, std::optional<double> apart = std::nullopt);

}  // namespace flatspeckle::mc
