#include "mc/imaging/media_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

namespace flatspeckle::mc {

namespace {

/// Returns the level that the maximum of a Gaussian field of unit variance in m dimensions exceeds
/// with a probability of one half. The logarithm of the expected number of maxima above u is
/// log_volume + (m - 1) ln(u) - u^2 / 2 (Adler, The Geometry of Random Fields).
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

/// Sum of the signals (peak heights over noise) of some pairs of points, and sum of their squares.
struct Sums {
  double plain = 0, squares = 0;

  void add(double signal, double sign = 1) {
    plain += sign * signal;
    squares += sign * signal * signal;
  }
  double evidence(bool weighted) const { return weighted ? squares : plain; }
};

/// Removes the points one by one, each time the point whose remaining pairs contribute least.
/// Returns, for each step, the sums over all pairs that have been removed so far.
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

/// Returns the number of pairs among n points that contain at least one of m given points.
double pairs_of(double n, double m) {
  return m * (2 * n - m - 1) / 2;
}

/// Returns the argument `log_volume` of median_of_largest() for the noise in the sums of all
/// objects with m of n points at wrong positions.
double log_volume(double n, double m, double places) {
  const double which = m + 1 < n ? log_binomial(n, m) : -std::numbers::ln2,
               determinant = (m - 1) * std::log(n) + std::log(n - m) - m * std::log(pairs_of(n, m)),
               turns = 2 * std::numbers::pi;
  return which + m * std::log(std::max(places, 1e-9)) - std::lgamma(m + 1) + determinant / 2 +
         m * std::log(turns / std::sqrt(10.0)) - (m + 1) / 2 * std::log(turns);
}

/// A class of wrong objects: the number of true pairs that they lack, and the dimensions and
/// `log_volume` of the field of noise in their sums (median_of_largest()).
struct Others {
  double pairs = 0, dimensions = 0, log_volume = 0;
};

/// Returns the probability that the true object has a larger sum than all objects of a class. The
/// sums of wrong objects contain noise and random coincidences with the true peaks.
double truth_wins(const Sums& lost, const Others& other, double places, bool weighted) {
  // integral of a squared peak, divided by the integral of the peak
  constexpr double of_square = 2.0 / 3;
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

/// Returns the probability that no object with m of n points at wrong positions is selected.
double points_stay(const Sums& lost, double m, double n, double places, bool weighted) {
  return truth_wins(lost, {pairs_of(n, m), m, log_volume(n, m, places)}, places, weighted);
}

/// Returns the probability that no object is selected in which all points on one side of a cut
/// through the line are moved or mirrored as a whole.
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

/// Returns the probability that no object is selected in which one point is mirrored at the centre
/// between two others.
double points_unmirrored(const PairTable& signal, bool weighted) {
  const std::size_t n = signal.size();
  if (n < 4) return 1;  // three points and their mirror image are the same object
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

double power_sum(const LineObject& object, int power) {
  double sum = 0;
  for (const double b : object.brightness) sum += std::pow(b, power);
  return sum;
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

MeanOverMedia mean_over(const std::vector<ImagedMedium>& media, double error_of_one,
                        const std::function<double(const ImagedMedium&)>& of) {
  const auto n = static_cast<double>(media.size());
  double sum = 0, squares = 0;
  for (const ImagedMedium& medium : media) {
    sum += of(medium) / n;
    squares += of(medium) * of(medium) / n;
  }
  if (media.size() == 1) return {sum, error_of_one};
  return {sum, std::sqrt(std::max(squares - sum * sum, 0.0) / (n - 1))};
}

MeanOverMedia share_of(const std::vector<ImagedMedium>& media,
                       const std::function<bool(const ImagedMedium&)>& holds) {
  return share_of(static_cast<double>(std::count_if(media.begin(), media.end(), holds)),
                  static_cast<double>(media.size()));
}

MeanOverMedia share_of(double found, double n) {
  const double likely = (found + 1) / (n + 2);
  return {found / n, std::sqrt(likely * (1 - likely) / (n + 3))};
}

MeanOverMedia root_of(const MeanOverMedia& square) {
  const double root = std::sqrt(std::max(square.value, 0.0));
  return {root, root > 0 ? square.error / (2 * root) : 0};
}

double mean_grains(const std::vector<ImagedMedium>& media) {
  return mean_over(media, 0, [](const ImagedMedium& m) { return m.statistics.grains; }).value;
}

FrameGrains frame_grains(const LineScene& line, const ImagingTask& task) {
  const auto frames = static_cast<double>(task.average);
  // Number of grains of the size grain_of() divided by most_grains(): these grains are 2/3 as long.
  constexpr double of_speckle = 1.5;
  return {of_speckle * most_grains(line) * frames, task.recovery.noise,
          static_cast<double>(line.camera.pixels) * frames};
}

double gaussian_contrast(const LineObject& object, double background) {
  return std::sqrt(power_sum(object, 2)) / power_sum(object, 1) / (1 + background);
}

MeanOverMedia mean_contrast(const LineObject& object, const std::vector<ImagedMedium>& media) {
  const double two = power_sum(object, 2), four = 6 * power_sum(object, 4);
  const double relative = std::sqrt((2 + four / (two * two)) / mean_grains(media));
  return root_of(mean_over(media, relative * media.front().statistics.square,
                           [](const ImagedMedium& m) { return m.statistics.square; }));
}

MeanOverMedia mean_fourth_moment(const std::vector<ImagedMedium>& media) {
  constexpr double eight = 2 + 6;  // 2 kappa_2^2 + kappa_4 of one point
  return mean_over(media, std::sqrt(eight / mean_grains(media)),
                   [](const ImagedMedium& m) { return m.fourth_moment; });
}

MeanOverMedia success_rate(const std::vector<ImagedMedium>& media) {
  return share_of(media, [](const ImagedMedium& medium) { return medium.score.found == 1; });
}

ExpectedPeaks expected_peaks(const LineScene& line, const ImagingTask& task,
                             const ImagingPrediction& prediction) {
  const FrameGrains frame = frame_grains(line, task);
  ExpectedPeaks expected;
  expected.signals = peaks_over_noise(line.object, real_parts(prediction.correlation.value), frame);
  const std::size_t points = line.object.x.size();
  if (points < 2 || task.recovery.points != points) return expected;
  const double band = most_grains(line) / static_cast<double>(line.camera.pixels),
               places = band * static_cast<double>(task.recovery.lags);
  const auto searched =
      filtered_peaks_over_noise(line.object, real_parts(prediction.correlation.value), frame, band);
  expected.success =
      predicted_success(searched, points, places, task.recovery.memory_range > 0, line.object.x);
  return expected;
}

std::size_t alike_pairs(const LineScene& line, double grains) {
  const LineObject at = shifts(line);
  std::vector<double> distances;
  for (std::size_t i = 0; i < at.x.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) distances.push_back(std::abs(at.x[i] - at.x[j]));
  std::sort(distances.begin(), distances.end());
  const double grain = static_cast<double>(line.camera.pixels) / most_grains(line) * 2 / 3;
  std::size_t alike = 0;
  for (std::size_t i = 1; i < distances.size(); ++i)
    alike += distances[i] - distances[i - 1] < grains * grain;
  return alike;
}

MeanOverMedia mean_psnr(const std::vector<ImagedMedium>& media) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  return mean_over(media, unknown, [](const ImagedMedium& m) { return m.psnr; });
}

}  // namespace flatspeckle::mc
