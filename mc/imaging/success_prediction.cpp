#include "mc/imaging/success_prediction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

namespace flatspeckle::mc {

namespace {

/// Level that the largest of a Gaussian field of unit variance exceeds with a probability of one
/// half, where the logarithm of the expected number of maxima above u is log_volume + (m - 1) ln(u)
/// - u^2 / 2 (Adler, The Geometry of Random Fields).
double median_of_largest(double log_volume, double m) {
  const double wanted = log_volume - std::log(std::numbers::ln2);
  double low = std::sqrt(std::max(m - 1, 0.0)), high = low + 100;
  const auto more = [&](double u) {
    return wanted + (m - 1) * std::log(std::max(u, 1e-9)) - u * u / 2 > 0;
  };
  if (!more(low + 1e-9)) return 0;
  while (high - low > 1e-6) (more((low + high) / 2) ? low : high) = (low + high) / 2;
  return low;
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

/// What the peaks of pairs, each as wide as a place, add to the autocorrelation at a lag that is
/// none of them: mean and variance.
struct Crowd {
  double mean = 0, square = 0;

  Crowd(std::span<const double> signals, double places) {
    constexpr double of_square = 2.0 / 3;  // integral of a peak's square over that of the peak
    for (const double signal : signals) {
      mean += signal / std::max(places, 1.0);
      square += of_square * signal * signal / std::max(places, 1.0);
    }
  }
};

double log_binomial(double n, double m) {
  return std::lgamma(n + 1) - std::lgamma(m + 1) - std::lgamma(n - m + 1);
}

/// Pairs of n points of which at least one is among m of them.
double pairs_of(double n, double m) {
  return m * (2 * n - m - 1) / 2;
}

/// As median_of_largest() wants it, of objects that have m of n points elsewhere.
double log_volume(double n, double m, double places) {
  const double which = m + 1 < n ? log_binomial(n, m) : -std::numbers::ln2,
               determinant = (m - 1) * std::log(n) + std::log(n - m) - m * std::log(pairs_of(n, m)),
               turns = 2 * std::numbers::pi;
  return which + m * std::log(std::max(places, 1e-9)) - std::lgamma(m + 1) + determinant / 2 +
         m * std::log(turns / std::sqrt(10.0)) - (m + 1) / 2 * std::log(turns);
}

}  // namespace

double predicted_success(std::span<const double> signals, std::size_t points, double places,
                         bool weighted) {
  std::vector<double> evidence(signals.begin(), signals.end());
  if (weighted)
    for (double& each : evidence) each *= each;
  const Crowd crowd(signals, places);
  double success = 1;
  std::size_t elsewhere = 0;
  for (const double sum : least_sums(by_points(evidence, points))) {
    const auto m = static_cast<double>(++elsewhere), n = static_cast<double>(points);
    const double pairs = pairs_of(n, m), share = pairs / pairs_of(n, n - 1),
                 truth = weighted ? std::sqrt(sum) : sum / std::sqrt(pairs),
                 mean = share * crowd.mean,
                 variance = std::max(share * crowd.square - mean * mean, 0.0),
                 others = mean * std::sqrt(pairs) +
                          std::sqrt(1 + variance) * median_of_largest(log_volume(n, m, places), m);
    success = std::min(success, normal_distribution(truth - others));
  }
  return success;
}

}  // namespace flatspeckle::mc
