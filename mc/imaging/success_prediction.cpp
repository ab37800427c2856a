#include "mc/imaging/success_prediction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
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

/// Of pairs' signals.
struct Sums {
  double plain = 0, squares = 0;

  void add(double signal, double sign = 1) {
    plain += sign * signal;
    squares += sign * signal * signal;
  }
  double evidence(bool weighted) const { return weighted ? squares : plain; }
};

/// Takes the points away one by one, each the one whose remaining pairs bring least; the sums of
/// what is taken, after each.
std::vector<Sums> least_sums(const PairTable& signal, bool weighted) {
  const std::size_t n = signal.size();
  std::vector<Sums> left(n), taken;
  for (std::size_t i = 0; i < n; ++i)
    for (const double each : signal[i]) left[i].add(each);
  std::vector<bool> gone(n);
  Sums sum;
  for (std::size_t m = 1; m < n; ++m) {
    std::size_t least = n;
    for (std::size_t i = 0; i < n; ++i)
      if (!gone[i] && (least == n || left[i].evidence(weighted) < left[least].evidence(weighted)))
        least = i;
    gone[least] = true;
    sum.plain += left[least].plain;
    sum.squares += left[least].squares;
    taken.push_back(sum);
    for (std::size_t i = 0; i < n; ++i) left[i].add(signal[least][i], -1);
  }
  return taken;
}

double normal_distribution(double x) {
  return std::erfc(-x / std::numbers::sqrt2) / 2;
}

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

/// That noise and chance meetings with the true peaks do not raise another object, with m of the
/// points elsewhere, above the true one.
double truth_wins(const Sums& lost, double m, double n, double places, bool weighted) {
  constexpr double of_square = 2.0 / 3;  // integral of a peak's square over that of the peak
  const double root = weighted ? std::sqrt(lost.squares) : std::sqrt(pairs_of(n, m));
  if (root == 0) return 0;
  const double met = lost.plain / std::max(places, 1.0),
               variance =
                   std::max(of_square * lost.squares / std::max(places, 1.0) - met * met, 0.0),
               truth = lost.evidence(weighted) / root,
               others = met * (weighted ? lost.plain : pairs_of(n, m)) / root +
                        std::sqrt(1 + variance) * median_of_largest(log_volume(n, m, places), m);
  return normal_distribution(truth - others);
}

}  // namespace

double predicted_success(std::span<const double> signals, std::size_t points, double places,
                         bool weighted) {
  double success = 1;
  std::size_t elsewhere = 0;
  for (const Sums& lost : least_sums(by_points(signals, points), weighted))
    success = std::min(success, truth_wins(lost, static_cast<double>(++elsewhere),
                                           static_cast<double>(points), places, weighted));
  return success;
}

}  // namespace flatspeckle::mc
