// Predicted probability of finding all points, from the signals of the pairs alone.
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "mc/imaging/media_statistics.h"
#include "mc/imaging/recovery/image_score.h"
#include "mc/imaging/recovery/recovery.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_success {

namespace {

using flatspeckle::tests::is_night;

/// Returns the share of searches that find all points, with peaks of height `signal` in white noise
/// of unit variance.
double found_share(const LineObject& object, double signal, std::size_t lags, int runs,
                   std::mt19937& random) {
  std::normal_distribution<double> noise(0, 1);
  double found = 0;
  for (int run = 0; run < runs; ++run) {
    std::vector<double> values(lags);
    for (double& value : values) value = noise(random);
    for (std::size_t i = 0; i < object.x.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        values[static_cast<std::size_t>(std::abs(object.x[i] - object.x[j]))] += signal;
    const SparseFit fit = sparse_search(
        {1, values, 1, signal * static_cast<double>(object.x.size())}, {object.x.size(), 1, 1000});
    found += score(object, fit.object, 0.5).found == 1;
  }
  return found / runs;
}

/// Returns the signal of all pairs at which half of the searches are predicted to succeed.
double half(std::size_t points, double places) {
  double low = 0, high = 20;
  while (high - low > 1e-3) {
    const double middle = (low + high) / 2;
    const std::vector<double> signals(points * (points - 1) / 2, middle);
    (predicted_success(signals, points, places) < 0.5 ? low : high) = middle;
  }
  return low;
}

}  // namespace

TEST_CASE("predicted success: the threshold signal agrees with searches") {
  std::mt19937 random(1);
  constexpr std::size_t lags = 120;
  const int runs = is_night ? 40 : 25;
  constexpr double white = 0.5;  // cycles per lag: the full band
  const LineObject four{{0, 13, 50, 96}, {1, 1, 1, 1}},
      six{{0, 9, 23, 53, 70, 95}, {1, 1, 1, 1, 1, 1}};
  for (const LineObject& object : {four, six}) {
    const double signal = half(object.x.size(), white * lags);
    CAPTURE(object.x.size());
    CAPTURE(signal);
    CHECK(found_share(object, signal / 2, lags, runs, random) < (is_night ? 0.2 : 0.3));
    CHECK(found_share(object, 1.5 * signal, lags, runs, random) > 0.5);
  }
}

TEST_CASE("sparse search: distances in the result differ by more than the resolution") {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1);
  constexpr double resolution = 3.2;
  for (int run = 0; run < 20; ++run) {
    std::vector<double> white(304), wide(300);
    for (double& value : white) value = noise(random);
    for (std::size_t i = 0; i < wide.size(); ++i)
      for (std::size_t j = 0; j < 5; ++j) wide[i] += white[i + j] / std::sqrt(5.0);
    const SparseFit fit =
        sparse_search({.step = 1, .height = wide, .noise = 1, .alone = 12}, {6, resolution, 300});
    std::vector<double> distances{0};
    for (const double a : fit.object.x)
      for (const double b : fit.object.x)
        if (a > b) distances.push_back(a - b);
    std::sort(distances.begin(), distances.end());
    for (std::size_t i = 1; i < distances.size(); ++i)
      CHECK(distances[i] - distances[i - 1] > resolution - 1e-9);
  }
}

TEST_CASE("sparse search: a known memory-effect range finds objects larger than it") {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 1);
  const LineObject object{{0, 41, 111, 163, 240}, {1, 1, 1, 1, 1}};
  constexpr double signal = 7, range = 120;
  const int runs = is_night ? 40 : 25;
  double unweighted = 0, weighted = 0;
  for (int run = 0; run < runs; ++run) {
    PairPeaks peaks{.step = 1, .height = std::vector<double>(300), .noise = 1, .alone = 5 * signal};
    for (double& value : peaks.height) value = noise(random);
    for (std::size_t i = 0; i < object.x.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const double distance = object.x[i] - object.x[j];
        peaks.height[static_cast<std::size_t>(distance)] +=
            signal * memory_correlation(distance, range);
      }
    const auto found = [&](double known) {
      const SparseFit fit = sparse_search(peaks, {.points = 5, .memory_range = known});
      return score(object, fit.object, 1).found == 1;
    };
    unweighted += found(0);
    weighted += found(range);
  }
  CHECK(memory_correlation(range, range) == doctest::Approx(0.5).epsilon(1e-4));
  CHECK(weighted > 0.7 * runs);
  CHECK(weighted > unweighted + runs / 5);
}

TEST_CASE("predicted success: threshold of equal points is sqrt(4 ln(places) / points)") {
  CHECK(half(10, 1e6) == doctest::Approx(std::sqrt(4 * std::log(1e6) / 10)).epsilon(0.2));
  CHECK(half(4, 1e8) == doctest::Approx(std::sqrt(4 * std::log(1e8) / 4)).epsilon(0.1));
}

TEST_CASE("predicted success: low for groups without mutual peaks and for mirror ambiguities") {
  std::vector<double> signals;  // 10 within two groups of three, none between them
  for (int i = 0; i < 6; ++i)
    for (int j = i + 1; j < 6; ++j) signals.push_back(i / 3 == j / 3 ? 10 : 0);
  const std::vector<double> x{0, 7, 10, 50, 61, 80};
  CHECK(predicted_success(signals, 6, 100, false, x) < 0.01);
  CHECK(predicted_success(std::vector<double>(15, 10.0), 6, 100, false, x) > 0.99);
  // The last of four points has only two pairs with a peak, which its mirror image keeps.
  // Peaks are few among many places, so that nothing else fails.
  std::vector<double> mirrored(6, 10.0);
  CHECK(predicted_success(mirrored, 4, 1e4) > 0.99);
  mirrored.back() = 0;
  CHECK(predicted_success(mirrored, 4, 1e4) < 0.7);
  CHECK(predicted_success(mirrored, 4, 10) < 0.7);
}

TEST_CASE("predicted success: limited by the dimmest point, zero without signal") {
  std::vector<double> signals(6, 10.0);
  CHECK(predicted_success(signals, 4, 100) > 0.999);
  signals[2] = signals[4] = signals[5] = 0.1;        // pairs of the last point
  CHECK(predicted_success(signals, 4, 100) < 0.02);  // one of 100 places at random
  CHECK(predicted_success(std::vector<double>(6, 0.0), 4, 100) < 0.01);
  CHECK(predicted_success(std::vector<double>{5}, 2, 100) == doctest::Approx(1).epsilon(0.05));
}

}  // namespace flatspeckle::mc::test_success
