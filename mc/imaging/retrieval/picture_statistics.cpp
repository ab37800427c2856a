#include "mc/imaging/retrieval/picture_statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "core/numbers/fourier.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/recovery/line_spectrum.h"

namespace flatspeckle::mc {

namespace {

/// Returns the weight of the pixels of a line in Gaussian averages over it: averages of 1.
std::vector<double> inside_weights(std::size_t pixels, double width) {
  std::vector<double> weights;
  const double scale = 1 / (std::numbers::sqrt2 * width);
  for (std::size_t p = 0; p < pixels; ++p) {
    const double before = static_cast<double>(p) + 0.5,
                 after = static_cast<double>(pixels) - before;
    weights.push_back((std::erf(before * scale) + std::erf(after * scale)) / 2);
  }
  return weights;
}

/// A picture in the corner of a larger array of zeros, for transforms that do not wrap around.
class Padded {
 public:
  Padded(std::size_t rows, std::size_t columns, double beyond)
      : transform_(transform_size(static_cast<double>(rows) + beyond),
                   transform_size(static_cast<double>(columns) + beyond)),
        rows_(rows),
        columns_(columns),
        values_(transform_.rows() * transform_.columns()),
        spectrum_(transform_.spectrum_size()) {}

  void set(std::span<const double> picture) {
    std::ranges::fill(values_, 0);
    for (std::size_t row = 0; row < rows_; ++row)
      std::ranges::copy(picture.subspan(row * columns_, columns_),
                        values_.begin() + static_cast<long>(row * transform_.columns()));
  }
  /// Multiplies the spectrum by factor(row, column, value); frequencies are in cycles per pixel.
  template <typename Factor>
  void filter(const Factor& factor) {
    transform_.forward(values_.data(), spectrum_.data());
    const double per_value = 1 / static_cast<double>(values_.size());
    for (std::size_t row = 0; row < transform_.rows(); ++row)
      for (std::size_t column = 0; column < transform_.spectrum_columns(); ++column) {
        Complex& value = spectrum_[row * transform_.spectrum_columns() + column];
        value = per_value * factor(row, column, value);
      }
    transform_.backward(spectrum_.data(), values_.data());
  }
  /// Returns the value at an offset, which may be negative and then wraps around.
  double at(long y, long x) const {
    const auto rows = static_cast<long>(transform_.rows()),
               columns = static_cast<long>(transform_.columns());
    return values_[static_cast<std::size_t>((y < 0 ? y + rows : y) * columns +
                                            (x < 0 ? x + columns : x))];
  }
  const PlaneTransform& transform() const { return transform_; }

 private:
  PlaneTransform transform_;
  std::size_t rows_, columns_;
  std::vector<double> values_;
  std::vector<Complex> spectrum_;
};

/// Returns the Gaussian of gaussian_spectrum() at each frequency of a line.
std::vector<double> gaussian_line(std::size_t frequencies, std::size_t size, double width) {
  std::vector<double> line;
  for (std::size_t m = 0; m < frequencies; ++m)
    line.push_back(gaussian_spectrum(
        static_cast<double>(std::min(m, size - m)) / static_cast<double>(size), width));
  return line;
}

std::vector<double> envelope_of(std::span<const double> picture, std::size_t rows,
                                std::size_t columns, double width) {
  Padded padded(rows, columns, 6 * width);
  padded.set(picture);
  const PlaneTransform& transform = padded.transform();
  const auto down = gaussian_line(transform.rows(), transform.rows(), width),
             across = gaussian_line(transform.spectrum_columns(), transform.columns(), width);
  padded.filter([&](std::size_t row, std::size_t column, Complex value) {
    return down[row] * across[column] * value;
  });
  const auto down_weight = inside_weights(rows, width),
             across_weight = inside_weights(columns, width);
  std::vector<double> envelope;
  envelope.reserve(rows * columns);
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x)
      envelope.push_back(padded.at(static_cast<long>(y), static_cast<long>(x)) /
                         (down_weight[y] * across_weight[x]));
  const auto dark = std::ranges::find_if(envelope, [](double value) { return !(value > 0); });
  if (dark != envelope.end()) {
    const auto pixel = static_cast<std::size_t>(dark - envelope.begin());
    throw InputError("frames: the mean about row " + std::to_string(pixel / columns) + ", column " +
                     std::to_string(pixel % columns) +
                     " is not positive; leave dark margins out by region");
  }
  return envelope;
}

/// Autocorrelation at lags below twice the lags of the task.
struct Correlation {
  long lags = 0;
  std::vector<double> values;  ///< [y][x] from -(2 lags - 1) to 2 lags - 1

  explicit Correlation(std::size_t task_lags)
      : lags(static_cast<long>(task_lags)), values(static_cast<std::size_t>(side() * side())) {}
  long reach() const { return 2 * lags - 1; }
  long side() const { return 2 * reach() + 1; }
  double& at(long y, long x) {
    return values[static_cast<std::size_t>((y + reach()) * side() + x + reach())];
  }
  /// Calls f(y, x, value) for all lags.
  template <typename F>
  void each(const F& f) {
    for (long y = -reach(); y <= reach(); ++y)
      for (long x = -reach(); x <= reach(); ++x) f(y, x, at(y, x));
  }
  bool is_inside(long y, long x) const { return std::max(std::abs(y), std::abs(x)) < lags; }
};

/// Adds the autocorrelation of a picture, the mean product of pixels at each lag, times `share`.
void add_autocorrelation(std::span<const double> picture, std::size_t rows, std::size_t columns,
                         double share, Correlation& sum) {
  Padded padded(rows, columns, static_cast<double>(2 * sum.lags));
  padded.set(picture);
  padded.filter([](std::size_t, std::size_t, Complex value) { return Complex(std::norm(value)); });
  sum.each([&](long y, long x, double& value) {
    const auto pairs = static_cast<double>((static_cast<long>(rows) - std::abs(y)) *
                                           (static_cast<long>(columns) - std::abs(x)));
    value += share * padded.at(y, x) / pairs;
  });
}

/// Returns the excess of lag 0 over its extrapolation from lags 1 and 2 along both axes by a
/// parabola in the square of the lag; 0 if grains are not resolved.
double excess_at_zero(Correlation& correlation) {
  const double one = (correlation.at(0, 1) + correlation.at(1, 0)) / 2,
               two = (correlation.at(0, 2) + correlation.at(2, 0)) / 2;
  constexpr double resolved = 0.6;
  if (!(two > resolved * one)) return 0;
  return std::max(0.0, correlation.at(0, 0) - (4 * one - two) / 3);
}

/// Mean and standard deviation at lags beyond those of the object.
std::pair<double, double> beyond_object(Correlation& correlation) {
  double sum = 0, squares = 0, count = 0;
  correlation.each([&](long y, long x, double value) {
    if (correlation.is_inside(y, x)) return;
    sum += value;
    squares += value * value;
    ++count;
  });
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean))};
}

/// Computes the statistics from an autocorrelation. white: camera noise in its value at lag 0.
PictureStatistics statistics_of(Correlation correlation, double white) {
  PictureStatistics found;
  found.white = white;
  correlation.at(0, 0) -= white;
  double pedestal = 0;
  std::tie(pedestal, found.noise) = beyond_object(correlation);
  double above_half = 0;
  const double peak = correlation.at(0, 0) - pedestal;
  correlation.each([&](long y, long x, double value) {
    if (!correlation.is_inside(y, x)) return;
    found.autocorrelation.push_back(value - pedestal);
    if (value - pedestal > peak / 2) ++above_half;
  });
  found.contrast = std::sqrt(std::max(0.0, correlation.at(0, 0)));
  found.grain = std::sqrt(4 * above_half / std::numbers::pi);
  return found;
}

}  // namespace

double picture_envelope_width(std::size_t pixels, std::size_t lags) {
  return static_cast<double>(std::min(2 * lags, std::max<std::size_t>(32, pixels / 32)));
}

std::vector<double> picture_without_envelope(std::span<const double> picture, std::size_t rows,
                                             std::size_t columns, double width) {
  const auto envelope = envelope_of(picture, rows, columns, width);
  std::vector<double> rest(picture.size());
  for (std::size_t p = 0; p < rest.size(); ++p) rest[p] = picture[p] / envelope[p] - 1;
  return rest;
}

PictureStatistics picture_statistics(const Frames& frames, std::size_t first, std::size_t count,
                                     std::size_t lags, const CameraNoise& noise) {
  const double share = 1 / static_cast<double>(count),
               width = picture_envelope_width(std::min(frames.rows, frames.columns), lags);
  Correlation correlation(lags);
  double variance = 0, white = 0;
  for (std::size_t number = first; number < first + count; ++number) {
    const auto frame = frames.frame(number);
    const auto envelope = envelope_of(frame, frames.rows, frames.columns, width);
    std::vector<double> rest(frame.size());
    const double mean = mean_of(frame);
    double shot = 0;
    for (std::size_t p = 0; p < rest.size(); ++p) {
      rest[p] = frame[p] / envelope[p] - 1;
      shot += noise_variance(noise, envelope[p] / mean);
    }
    white += share * shot / static_cast<double>(rest.size());
    variance += share * std::inner_product(rest.begin(), rest.end(), rest.begin(), 0.0) /
                static_cast<double>(rest.size());
    add_autocorrelation(rest, frames.rows, frames.columns, share, correlation);
  }
  if (noise.photons == 0) white = excess_at_zero(correlation);
  const double at_zero = correlation.at(0, 0);
  PictureStatistics found = statistics_of(std::move(correlation), white);
  constexpr double rounding = 1e-10;
  if (variance > 0) found.variance = {std::abs(at_zero / variance - 1), rounding};
  return found;
}

}  // namespace flatspeckle::mc
