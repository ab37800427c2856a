#include "mc/imaging/success_prediction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

namespace flatspeckle::mc {

namespace {

/// Of the largest of exp(log_count) normal numbers: where each is larger with the probability
/// ln 2 / count, from the leading terms of the normal distribution's tail.
double median_of_largest(double log_count) {
  const double tail = log_count - std::log(std::numbers::ln2);
  if (tail < 1) return 0;
  const double leading = 2 * tail;
  return std::sqrt(std::max(leading - std::log(2 * std::numbers::pi * leading), 0.0));
}

using PairTable = std::vector<std::vector<double>>;

PairTable by_points(std::span<const double> signals, std::size_t points) {
  PairTable of(points, std::vector<double>(points));
  std::size_t pair = 0;
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t j = i + 1; j < points; ++j) of[i][j] = of[j][i] = signals[pair++];
  return of;
}

/// Takes the points away one by one, each the one whose remaining pairs bring least; the sums of
/// what is taken, after each.
std::vector<double> least_sums(const PairTable& signal) {
  const std::size_t n = signal.size();
  std::vector<double> left(n);
  for (std::size_t i = 0; i < n; ++i) left[i] = std::reduce(signal[i].begin(), signal[i].end());
  std::vector<double> sums;
  double sum = 0;
  for (std::size_t m = 1; m < n; ++m) {
    const auto least =
        static_cast<std::size_t>(std::min_element(left.begin(), left.end()) - left.begin());
    sums.push_back(sum += left[least]);
    for (std::size_t i = 0; i < n; ++i) left[i] -= signal[least][i];
    left[least] = std::numeric_limits<double>::infinity();
  }
  return sums;
}

double normal_distribution(double x) {
  return std::erfc(-x / std::numbers::sqrt2) / 2;
}

}  // namespace

double predicted_success(std::span<const double> signals, std::size_t points, double places) {
  double success = 1;
  std::size_t elsewhere = 0;
  for (const double sum : least_sums(by_points(signals, points))) {
    const auto m = static_cast<double>(++elsewhere), n = static_cast<double>(points),
               pairs = std::sqrt(m * (2 * n - m - 1) / 2),
               mirrored = elsewhere + 1 == points ? std::numbers::ln2 : 0,
               others = m * std::log(std::max(places, 1.0)) - std::lgamma(m + 1) - mirrored;
    success = std::min(success, normal_distribution(sum / pairs - median_of_largest(others)));
  }
  return success;
}

}  // namespace flatspeckle::mc
