#include "mc/imaging/success_prediction.h"

#include <algorithm>
#include <cmath>
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

/// Objects that lack so many pairs of the true one, in a field of so many dimensions.
struct Others {
  double pairs = 0, dimensions = 0, log_volume = 0;
};

/// That noise and chance meetings with the true peaks do not raise another object above the true
/// one.
double truth_wins(const Sums& lost, const Others& other, double places, bool weighted) {
  constexpr double of_square = 2.0 / 3;  // integral of a peak's square over that of the peak
  const double root = weighted ? std::sqrt(lost.squares) : std::sqrt(other.pairs);
  if (root == 0) return 0;
  const double met = lost.plain / std::max(places, 1.0),
               variance =
                   std::max(of_square * lost.squares / std::max(places, 1.0) - met * met, 0.0),
               truth = lost.evidence(weighted) / root,
               others =
                   met * (weighted ? lost.plain : other.pairs) / root +
                   std::sqrt(1 + variance) * median_of_largest(other.log_volume, other.dimensions);
  return normal_distribution(truth - others);
}

/// With m of n points elsewhere.
double points_stay(const Sums& lost, double m, double n, double places, bool weighted) {
  return truth_wins(lost, {pairs_of(n, m), m, log_volume(n, m, places)}, places, weighted);
}

/// That no cut between neighbours lets one side move, or be mirrored, as a whole.
double groups_stay(const PairTable& signal, std::span<const double> x, double places,
                   bool weighted) {
  std::vector<std::size_t> along(x.size());
  std::iota(along.begin(), along.end(), std::size_t{0});
  std::sort(along.begin(), along.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  const auto n = static_cast<double>(x.size());
  const double volume = log_volume(n, 1, places) - std::log(n) + std::log(2.0);
  double stay = 1;
  for (std::size_t cut = 2; cut + 2 <= x.size(); ++cut) {
    Sums across;
    for (std::size_t i = 0; i < cut; ++i)
      for (std::size_t j = cut; j < x.size(); ++j) across.add(signal[along[i]][along[j]]);
    const auto left = static_cast<double>(cut);
    stay = std::min(stay, truth_wins(across, {left * (n - left), 1, volume}, places, weighted));
  }
  return stay;
}

/// That no point is taken for its mirror image between two others.
double points_unmirrored(const PairTable& signal, bool weighted) {
  const std::size_t n = signal.size();
  if (n < 4) return 1;  // three points that are mirrored are the same object
  double winners = 0;
  for (std::size_t k = 0; k < n; ++k) {
    Sums all;
    for (const double each : signal[k]) all.add(each);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j) {
        if (i == k || j == k) continue;
        Sums lost = all;
        lost.add(signal[k][i], -1);
        lost.add(signal[k][j], -1);
        const double variance = weighted ? lost.squares : static_cast<double>(n - 3);
        winners += variance > 0
                       ? normal_distribution(-lost.evidence(weighted) / std::sqrt(2 * variance))
                       : 0.5;
      }
  }
  return std::exp(-winners);
}

}  // namespace

double predicted_success(std::span<const double> signals, std::size_t points, double places,
                         bool weighted, std::span<const double> x) {
  const PairTable signal = by_points(signals, points);
  double success = x.empty() ? 1 : groups_stay(signal, x, places, weighted);
  std::size_t elsewhere = 0;
  for (const Sums& lost : least_sums(signal, weighted))
    success = std::min(success, points_stay(lost, static_cast<double>(++elsewhere),
                                            static_cast<double>(points), places, weighted));
  return success * points_unmirrored(signal, weighted);
}

}  // namespace flatspeckle::mc
