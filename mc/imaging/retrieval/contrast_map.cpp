#include "mc/imaging/retrieval/contrast_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/retrieval/picture_statistics.h"

namespace flatspeckle::mc {

namespace {

/// Sums of values over windows of a picture, in constant time for each.
class WindowSums {
 public:
  WindowSums(const std::vector<double>& values, std::size_t rows, std::size_t columns)
      : stride_(columns + 1), sums_((rows + 1) * stride_) {
    for (std::size_t y = 0; y < rows; ++y) {
      double row = 0;
      for (std::size_t x = 0; x < columns; ++x) {
        row += values[y * columns + x];
        sums_[(y + 1) * stride_ + x + 1] = sums_[y * stride_ + x + 1] + row;
      }
    }
  }

  double sum(std::size_t y, std::size_t x, std::size_t side) const {
    return at(y + side, x + side) - at(y, x + side) - at(y + side, x) + at(y, x);
  }

 private:
  double at(std::size_t y, std::size_t x) const { return sums_[y * stride_ + x]; }

  std::size_t stride_;
  std::vector<double> sums_;
};

/// Sums over windows of a frame. Values are relative to the mean of the frame, which keeps the
/// digits of small variances.
struct FrameSums {
  double middle;  ///< mean of the frame
  std::vector<double> values;
  WindowSums all, squares;

  explicit FrameSums(const Frames& frames, std::size_t number)
      : middle(mean_of(frames.frame(number))),
        values(relative(frames.frame(number), middle)),
        all(values, frames.rows, frames.columns),
        squares(squared(values), frames.rows, frames.columns) {}

  /// Returns mean, relative to `middle`, and variance of the pixels of a window.
  std::pair<double, double> moments(std::size_t y, std::size_t x, std::size_t side) const {
    const auto pixels = static_cast<double>(side * side);
    const double mean = all.sum(y, x, side) / pixels;
    return {mean, squares.sum(y, x, side) / pixels - mean * mean};
  }

 private:
  static std::vector<double> relative(std::span<const double> frame, double middle) {
    std::vector<double> values(frame.begin(), frame.end());
    for (double& value : values) value -= middle;
    return values;
  }
  static std::vector<double> squared(std::vector<double> values) {
    for (double& value : values) value *= value;
    return values;
  }
};

/// Mean correlation of two pixels of a window, and mean squared correlation.
struct WindowCorrelation {
  double mean = 0, square = 0;
};

WindowCorrelation window_correlation(const Frames& frames, std::size_t window) {
  if (window == 1) return {1, 1};
  const std::size_t lags = std::max<std::size_t>(window, 4);
  const auto found = picture_statistics(frames, 0, frames.count(), lags, {});
  const auto side = static_cast<long>(2 * lags - 1), middle = static_cast<long>(lags - 1),
             reach = static_cast<long>(window - 1);
  const auto at = [&](long y, long x) {
    return found.autocorrelation[static_cast<std::size_t>((middle + y) * side + middle + x)];
  };
  WindowCorrelation mean;
  const auto w = static_cast<double>(window);
  for (long y = -reach; y <= reach; ++y)
    for (long x = -reach; x <= reach; ++x) {
      const double pairs = (w - static_cast<double>(std::abs(y))) *
                           (w - static_cast<double>(std::abs(x))) / std::pow(w, 4),
                   correlation = at(0, 0) > 0 ? at(y, x) / at(0, 0) : 0;
      mean.mean += pairs * correlation;
      mean.square += pairs * correlation * correlation;
    }
  const double least = 1 / (w * w);
  return {std::clamp(mean.mean, least, 1.0), std::clamp(mean.square, least, 1.0)};
}

/// Sums over frames, for each pixel of the map: of the variance of the light, of its mean, and of
/// the squared mean without the variance of the estimated mean.
struct MapSums {
  std::vector<double> variance, mean, square;

  explicit MapSums(std::size_t pixels) : variance(pixels), mean(pixels), square(pixels) {}
  void add(std::size_t pixel, double one_variance, double one_mean, double of_mean, double share) {
    variance[pixel] += share * one_variance;
    mean[pixel] += share * one_mean;
    square[pixel] += share * (one_mean * one_mean - of_mean * one_variance);
  }
};

double noise_of(const ContrastTask& task, double mean) {
  return task.per_photon * mean + task.read_noise * task.read_noise;
}

/// Adds the statistics of the windows of each frame.
void add_windows(const Frames& frames, const ContrastTask& task, double correlation,
                 const ContrastMap& map, MapSums& sums) {
  const auto pixels = static_cast<double>(task.window * task.window),
             share = 1 / static_cast<double>(frames.count());
  for (std::size_t number = 0; number < frames.count(); ++number) {
    const FrameSums frame(frames, number);
    for (std::size_t y = 0; y < map.rows; ++y)
      for (std::size_t x = 0; x < map.columns; ++x) {
        const auto [relative, variance] = frame.moments(y, x, task.window);
        const double mean = frame.middle + relative,
                     noise = noise_of(task, mean) * (1 - 1 / pixels);
        sums.add(y * map.columns + x, (variance - noise) / (1 - correlation), mean, correlation,
                 share);
      }
  }
}

/// Adds the statistics over time of each pixel, averaged over windows.
void add_times(const Frames& frames, const ContrastTask& task, const ContrastMap& map,
               MapSums& sums) {
  const auto count = static_cast<double>(frames.count());
  std::vector<double> means(frames.pixels()), variances(frames.pixels()), squares(frames.pixels());
  for (std::size_t p = 0; p < frames.pixels(); ++p) {
    for (std::size_t number = 0; number < frames.count(); ++number)
      means[p] += frames.frame(number)[p] / count;
    for (std::size_t number = 0; number < frames.count(); ++number)
      variances[p] += std::pow(frames.frame(number)[p] - means[p], 2) / (count - 1);
    const double light = variances[p] - noise_of(task, means[p]);
    squares[p] = means[p] * means[p] - variances[p] / count;
    variances[p] = light;
  }
  const WindowSums all(means, frames.rows, frames.columns),
      all_variances(variances, frames.rows, frames.columns),
      all_squares(squares, frames.rows, frames.columns);
  const auto pixels = static_cast<double>(task.window * task.window);
  for (std::size_t y = 0; y < map.rows; ++y)
    for (std::size_t x = 0; x < map.columns; ++x) {
      const std::size_t pixel = y * map.columns + x;
      sums.variance[pixel] = all_variances.sum(y, x, task.window) / pixels;
      sums.mean[pixel] = all.sum(y, x, task.window) / pixels;
      sums.square[pixel] = all_squares.sum(y, x, task.window) / pixels;
    }
}

/// Checks the law of total variance for separate windows of the first frame.
Invariant total_variance(const Frames& frames, std::size_t window) {
  const FrameSums frame(frames, 0);
  const std::size_t rows = frames.rows / window, columns = frames.columns / window;
  double within = 0;
  std::vector<double> means, inside;
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x) {
      const auto [mean, variance] = frame.moments(y * window, x * window, window);
      means.push_back(mean);
      within += variance;
      for (std::size_t row = 0; row < window; ++row)
        for (std::size_t column = 0; column < window; ++column)
          inside.push_back(frame.values[(y * window + row) * frames.columns + x * window + column]);
    }
  const auto variance_of = [](const std::vector<double>& list) {
    const double mean = mean_of(list);
    double sum = 0;
    for (const double value : list) sum += (value - mean) * (value - mean);
    return sum / static_cast<double>(list.size());
  };
  const double whole = variance_of(inside),
               parts = within / static_cast<double>(means.size()) + variance_of(means);
  constexpr double rounding = 1e-9;
  return {whole > 0 ? std::abs(parts / whole - 1) : 0, rounding};
}

}  // namespace

ContrastMap contrast_map(const Frames& frames, const ContrastTask& task) {
  ContrastMap map;
  map.rows = frames.rows - task.window + 1;
  map.columns = frames.columns - task.window + 1;
  const auto correlation = window_correlation(frames, task.window);
  map.correlation = correlation.mean;
  map.variance = total_variance(frames, task.window);
  MapSums sums(map.rows * map.columns);
  const bool over_time = task.over == ContrastTask::Over::time;
  if (over_time)
    add_times(frames, task, map, sums);
  else
    add_windows(frames, task, correlation.mean, map, sums);
  const auto count = static_cast<double>(frames.count());
  const double repeats = over_time ? count - 1 : count;
  for (std::size_t p = 0; p < sums.mean.size(); ++p) {
    const double square = sums.square[p] > 0 ? sums.variance[p] / sums.square[p] : 0;
    const double noise = noise_of(task, sums.mean[p]) / std::max(sums.square[p], 1e-300);
    // The camera's noise is independent in all pixels.
    const double own = std::max(square, 0.0) * std::sqrt((2 + 6 * square) * correlation.square),
                 white = noise * std::sqrt(2.0) / static_cast<double>(task.window);
    map.square.push_back(square);
    map.error.push_back(std::hypot(own, white) / std::sqrt(repeats));
  }
  map.mean = std::move(sums.mean);
  return map;
}

double decays_per_exposure(double square, double beta) {
  if (!(square > 0)) return std::numeric_limits<double>::infinity();
  if (square >= beta) return 0;
  const auto contrast = [](double x) {
    return x < 1e-3 ? 1 - 2 * x / 3 : (std::expm1(-2 * x) + 2 * x) / (2 * x * x);
  };
  double low = 0, high = 1;
  while (contrast(high) > square / beta) high *= 2;
  for (int step = 0; step < 100 && high - low > 1e-12 * high; ++step) {
    const double middle = (low + high) / 2;
    (contrast(middle) > square / beta ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace flatspeckle::mc
