#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace flatspeckle::mc {

/// Two sources whose patterns are alike where one is shifted.
struct PatternShift {
  std::size_t first = 0, second = 0;
  double shift = 0;   ///< pixels from the first's pattern to the second's
  double height = 0;  ///< of the correlation there, C_I for speckle
  double noise = 0;   ///< its standard deviation elsewhere
};

/// Of all pairs whose correlation has a peak, within `lags` pixels, that chance makes in one of a
/// hundred such sets. patterns: [pixel][source].
std::vector<PatternShift> pattern_shifts(const Eigen::MatrixXd& patterns, std::size_t lags);

/// Where sources are that are joined by pairs, one to the next.
struct SourcePlaces {
  std::vector<double> x;           ///< pixels, the first of each group at 0
  std::vector<std::size_t> group;  ///< sources of one number are joined; 0: the largest
};

/// The tree of the highest peaks that reaches all it can, then least squares over the pairs that
/// agree with it within so many pixels, each weighted by its peak's square. An object may so be
/// longer than any two points share their speckle (Zhu et al. 2022).
SourcePlaces source_places(std::size_t sources, const std::vector<PatternShift>& shifts,
                           double within);

}  // namespace flatspeckle::mc
