#include "mc/imaging/recovery/ruler_fit.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle::mc {

double memory_correlation(double distance, double memory_range) {
  constexpr double at_half = 1.49143;  // (x / sinh x)^2 = 1/2
  const double x = memory_range > 0 ? at_half * distance / memory_range : 0;
  return x < 1e-4 ? 1 : std::pow(x / std::sinh(x), 2);
}

std::vector<double> expected_heights(const PairPeaks& peaks, const SparseTask& task) {
  const double equal = peaks.alone / static_cast<double>(task.points);
  std::vector<double> expected(peaks.height.size());
  for (std::size_t lag = 0; lag < expected.size(); ++lag)
    expected[lag] =
        equal * memory_correlation(static_cast<double>(lag) * peaks.step, task.memory_range);
  return expected;
}

namespace {

constexpr double spread = 1.0 / 3;  ///< of the brightness, over its mean

/// By cubic interpolation (Catmull and Rom).
double value_at(const std::vector<double>& line, double place) {
  const auto last = static_cast<long>(line.size()) - 1;
  const double lag = std::abs(place), below = std::floor(lag), t = lag - below;
  const auto at = [&](long offset) {
    return line[static_cast<std::size_t>(
        std::clamp(std::abs(static_cast<long>(below) + offset), 0L, last))];
  };
  const double a = at(-1), b = at(0), c = at(1), d = at(2);
  return b + t / 2 * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

/// Height of each pair and what points of mean brightness would have.
struct Pairs {
  std::size_t points;
  std::vector<double> height, expected;  ///< [i][j]

  Pairs(const PairPeaks& peaks, const std::vector<double>& means, const std::vector<double>& marks)
      : points(marks.size()), height(points * points), expected(points * points) {
    for (std::size_t i = 0; i < points; ++i)
      for (std::size_t j = 0; j < points; ++j)
        if (i != j) {
          height[i * points + j] = value_at(peaks.height, marks[i] - marks[j]);
          expected[i * points + j] = value_at(means, marks[i] - marks[j]);
        }
  }
};

/// The most likely brightness, one point after the other.
void improve_brightness(const Pairs& pairs, double variance, std::vector<double>& b) {
  constexpr int sweeps = 30;
  const double of_prior = variance / (spread * spread);
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

/// (2 h a - a^2) / s^2 over the pairs of point i.
double gain_of(const Pairs& pairs, const std::vector<double>& b, std::size_t i, double variance) {
  double gain = 0;
  for (std::size_t j = 0; j < b.size(); ++j) {
    const double a = pairs.expected[i * b.size() + j] * b[i] * b[j];
    gain += (2 * pairs.height[i * b.size() + j] - a) * a / variance;
  }
  return gain;
}

/// Whether marks, and all distances of two, are so far from each other.
bool are_distinct(const std::vector<double>& marks, double apart) {
  std::vector<double> distances{0};
  for (std::size_t i = 0; i < marks.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) distances.push_back(std::abs(marks[i] - marks[j]));
  std::sort(distances.begin(), distances.end());
  const auto nearer = [apart](double a, double b) { return b - a < apart; };
  return std::adjacent_find(distances.begin(), distances.end(), nearer) == distances.end();
}

/// Each mark by quarters of a step, one at most, while that makes the object likelier, and leaves
/// it distinct: else two pairs would have the same peak.
void improve_marks(const PairPeaks& peaks, const std::vector<double>& expected, double apart,
                   double variance, const std::vector<double>& b, std::vector<double>& marks) {
  constexpr int sweeps = 4;
  constexpr double shift = 0.25;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t i = 0; i < marks.size(); ++i) {
      const double from = marks[i];
      double best = from, most = -1e300;
      for (const double mark : {from, from - shift, from + shift}) {
        marks[i] = mark;
        if (mark != from && !are_distinct(marks, apart)) continue;
        const double gain = gain_of(Pairs(peaks, expected, marks), b, i, variance);
        if (gain > most) {
          most = gain;
          best = mark;
        }
      }
      marks[i] = best;
    }
}

}  // namespace

RulerFit fitted_ruler(const PairPeaks& peaks, const std::vector<double>& expected,
                      std::vector<double> marks, std::optional<double> apart) {
  const double variance = std::max(peaks.noise * peaks.noise, 1e-12 * peaks.alone * peaks.alone);
  RulerFit fit;
  fit.brightness.assign(marks.size(), 1);
  improve_brightness(Pairs(peaks, expected, marks), variance, fit.brightness);
  if (apart) improve_marks(peaks, expected, *apart, variance, fit.brightness, marks);
  const Pairs pairs(peaks, expected, marks);
  if (apart) improve_brightness(pairs, variance, fit.brightness);
  double product = 0, squares = 0, heights = 0;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    fit.gain += gain_of(pairs, fit.brightness, i, variance) / 2 -
                std::pow((fit.brightness[i] - 1) / spread, 2);
    for (std::size_t j = 0; j < marks.size(); ++j) {
      const std::size_t at = i * marks.size() + j;
      const double a = pairs.expected[at] * fit.brightness[i] * fit.brightness[j];
      product += pairs.height[at] * a;
      squares += a * a;
      heights += pairs.height[at] * pairs.height[at];
    }
  }
  if (squares > 0 && heights > 0) fit.explained = product / std::sqrt(squares * heights);
  fit.marks = std::move(marks);
  return fit;
}

}  // namespace flatspeckle::mc
