#pragma once

#include <cstddef>
#include <vector>

namespace flatspeckle::mc {

/// Height of the peak of each pair of points, and its expected height for points of mean
/// brightness; 0 for a point and itself.
struct PeakPairs {
  std::size_t points;
  std::vector<double> height, expected;  ///< [i][j]

  explicit PeakPairs(std::size_t count)
      : points(count), height(count * count), expected(count * count) {}
  /// Returns their agreement for points of brightness b (SparseFit::explained).
  double explained(const std::vector<double>& b) const;
};

/// Standard deviation of the prior distribution of the brightness, divided by its mean.
constexpr double brightness_spread = 1.0 / 3;

/// Optimises the brightness b of one point after the other. variance: variance of the heights.
void improve_brightness(const PeakPairs& pairs, double variance, std::vector<double>& b);

/// Returns the sum of (2 h a - a^2) / s^2 (sparse_search()) over the pairs of point i.
double gain_of(const PeakPairs& pairs, const std::vector<double>& b, std::size_t i,
               double variance);
/// Returns twice the log likelihood of brightness b, relative to that of an empty object.
double gain_of(const PeakPairs& pairs, const std::vector<double>& b, double variance);

}  // namespace flatspeckle::mc
