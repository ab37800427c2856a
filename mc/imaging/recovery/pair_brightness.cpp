#include "mc/imaging/recovery/pair_brightness.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle::mc {

double PeakPairs::explained(const std::vector<double>& b) const {
  double product = 0, squares = 0, heights = 0;
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t j = 0; j < points; ++j) {
      const std::size_t at = i * points + j;
      const double a = expected[at] * b[i] * b[j];
      product += height[at] * a;
      squares += a * a;
      heights += height[at] * height[at];
    }
  return squares > 0 && heights > 0 ? product / std::sqrt(squares * heights) : 0;
}

void improve_brightness(const PeakPairs& pairs, double variance, std::vector<double>& b) {
  constexpr int sweeps = 30;
  const double of_prior = variance / (brightness_spread * brightness_spread);
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t i = 0; i < b.size(); ++i) {
      double product = of_prior, square = of_prior;
      for (std::size_t j = 0; j < b.size(); ++j) {
        const double alone = pairs.expected[i * b.size() + j] * b[j];
        product += pairs.height[i * b.size() + j] * alone;
        square += alone * alone;
      }
      if (square > 0) b[i] = std::max(product / square, 0.0);
    }
}

double gain_of(const PeakPairs& pairs, const std::vector<double>& b, std::size_t i,
               double variance) {
  double gain = 0;
  for (std::size_t j = 0; j < b.size(); ++j) {
    const double a = pairs.expected[i * b.size() + j] * b[i] * b[j];
    gain += (2 * pairs.height[i * b.size() + j] - a) * a / variance;
  }
  return gain;
}

double gain_of(const PeakPairs& pairs, const std::vector<double>& b, double variance) {
  double gain = 0;
  for (std::size_t i = 0; i < b.size(); ++i)
    gain += gain_of(pairs, b, i, variance) / 2 - std::pow((b[i] - 1) / brightness_spread, 2);
  return gain;
}

}  // namespace flatspeckle::mc
