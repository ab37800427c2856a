#include "mc/paths/speckle/field_statistics.h"

#include <algorithm>
#include <cmath>
#include <fftw3.h>
#include <numeric>

#include "core/numbers/fourier.h"
#include "flatland/request/request.h"

namespace flatspeckle::mc {

namespace {

constexpr std::size_t fewest_views = 8;

// Positions of the quantities in the sums that each field adds.
constexpr std::size_t number_at = 0;   // number of values x
constexpr std::size_t moments_at = 1;  // sum of x, sum of x^2
constexpr std::size_t pseudo_at = 2;   // sum of u^2 / E|u|^2
// The histogram; the autocorrelation and the sums of x and x^2 of each channel follow it
constexpr std::size_t histogram_at = 3;
constexpr std::size_t lags_at = histogram_at + FieldStatistics::bins;

double ratio(double a, double b) {
  return b == 0 ? 0 : a / b;
}

/// Returns std / mean from the number of values, their sum (real part) and sum of squares
/// (imaginary part), which is first multiplied by `squares`.
double contrast_of(double number, Complex moments, double squares) {
  const double mean = ratio(moments.real(), number);
  const double variance = squares * ratio(moments.imag(), number) - mean * mean;
  return ratio(std::sqrt(std::max(variance, 0.0)), mean);
}

/// Returns an estimator of `count` means, sums[first ..] / sums[number_at].
Estimator per_value(std::size_t first, std::size_t count) {
  return [first, count](double, std::span<const Complex> sums) {
    std::vector<Complex> mean;
    const double number = sums[number_at].real();
    for (std::size_t i = 0; i < count; ++i)
      mean.push_back(number == 0 ? 0 : sums[first + i] / number);
    return mean;
  };
}

}  // namespace

std::optional<double> equal_step(const std::vector<View>& views) {
  if (views.size() < fewest_views) return std::nullopt;
  const bool near = views.front().near;
  const auto place = [&](std::size_t v) {
    const Vec w = views[v].direction();
    return near ? views[v].point : Vec{w.x, 0, w.y};
  };
  const Vec step = place(1) - place(0);
  /// Tolerance, relative to the step, for angles that are rounded in lists
  constexpr double rounding = 1e-3;
  for (std::size_t v = 1; v < views.size(); ++v) {
    const bool same_side = near || std::cos(views[v].angle) * std::cos(views[0].angle) >= 0;
    if (!same_side || length(place(v) - place(v - 1) - step) > rounding * length(step))
      return std::nullopt;
  }
  if (length(step) == 0) return std::nullopt;
  return length(step);
}

/// FFT plans for a line of values followed by as many zeros, so that the correlation does not wrap
/// around at the ends.
struct Autocorrelation::Plans {
  explicit Plans(std::size_t values) : size(2 * values) {
    std::vector<double> line(size);
    std::vector<Complex> spectrum(size / 2 + 1);
    auto* native = reinterpret_cast<fftw_complex*>(spectrum.data());
    const std::lock_guard lock(fourier_planning());
    const auto n = static_cast<int>(size);
    forward = fftw_plan_dft_r2c_1d(n, line.data(), native, FFTW_ESTIMATE | FFTW_UNALIGNED);
    backward = fftw_plan_dft_c2r_1d(n, native, line.data(), FFTW_ESTIMATE | FFTW_UNALIGNED);
  }
  Plans(const Plans&) = delete;
  Plans& operator=(const Plans&) = delete;
  ~Plans() {
    const std::lock_guard lock(fourier_planning());
    fftw_destroy_plan(forward);
    fftw_destroy_plan(backward);
  }
  std::size_t size;
  fftw_plan forward, backward;
};

Autocorrelation::Autocorrelation(std::size_t views)
    : views_(views), plans_(std::make_shared<const Plans>(views)) {}

std::vector<double> Autocorrelation::operator()(std::span<const double> x) const {
  std::vector<double> line(x.begin(), x.end());
  line.resize(plans_->size);
  std::vector<Complex> spectrum(plans_->size / 2 + 1);
  auto* native = reinterpret_cast<fftw_complex*>(spectrum.data());
  fftw_execute_dft_r2c(plans_->forward, line.data(), native);
  for (Complex& value : spectrum) value = std::norm(value);
  fftw_execute_dft_c2r(plans_->backward, native, line.data());
  line.resize(views_);
  for (std::size_t d = 0; d < views_; ++d)
    line[d] /= static_cast<double>(plans_->size) * static_cast<double>(views_ - d);
  return line;
}

FieldStatistics::FieldStatistics(std::vector<double> intensity, std::size_t views,
                                 bool autocorrelated, double squares, bool is_camera)
    : intensity_(std::move(intensity)), line_(0), squares_(squares), is_camera_(is_camera) {
  if (autocorrelated) {
    line_ = is_camera ? static_cast<std::size_t>(std::lround(std::sqrt(views))) : views;
    autocorrelation_.emplace(line_);
  }
  sums_ = GroupedSums(lags_at + line_ + intensity_.size());
}

/// Adds the autocorrelation of x - 1 over the line of views or, for a camera, that of |u|^2 -
/// E|u|^2 over its rows and columns.
void FieldStatistics::add_lags(std::span<const double> fluctuation, std::span<Complex> sums) const {
  const auto add_line = [&](std::span<const double> line, double weight) {
    const auto lags = (*autocorrelation_)(line);
    for (std::size_t d = 0; d < line_; ++d) sums[d] += weight * lags[d];
  };
  if (!is_camera_) return add_line(fluctuation.first(line_), 1);
  const std::size_t pixels = line_ * line_;
  const double mean =
      std::accumulate(intensity_.begin(), intensity_.begin() + static_cast<long>(pixels), 0.0) /
      static_cast<double>(pixels);
  if (mean == 0) return;
  std::vector<double> picture(pixels), column(line_);
  for (std::size_t c = 0; c < pixels; ++c) picture[c] = fluctuation[c] * intensity_[c] / mean;
  const double weight = 0.5 / static_cast<double>(line_);
  for (std::size_t i = 0; i < line_; ++i) {
    add_line(std::span(picture).subspan(i * line_, line_), weight);
    for (std::size_t row = 0; row < line_; ++row) column[row] = picture[row * line_ + i];
    add_line(column, weight);
  }
}

void FieldStatistics::add(std::span<const Complex> field) {
  std::vector<Complex> sums(sums_.size());
  std::vector<double> fluctuation(intensity_.size());
  const std::size_t channels_at = lags_at + line_;
  for (std::size_t c = 0; c < intensity_.size(); ++c) {
    if (intensity_[c] == 0) continue;
    const double x = std::norm(field[c]) / intensity_[c];
    fluctuation[c] = x - 1;
    sums[number_at] += 1;
    sums[moments_at] += Complex(x, x * x);
    sums[pseudo_at] += product(field[c], field[c]) / intensity_[c];
    const auto bin = static_cast<std::size_t>(std::min(x / bin_width, bins - 1.0));
    sums[histogram_at + bin] += 1;
    sums[channels_at + c] = Complex(x, x * x);
  }
  if (autocorrelation_) add_lags(fluctuation, std::span(sums).subspan(lags_at, line_));
  sums_.add(1, sums);
}

Estimate FieldStatistics::mean_contrast() const {
  return jackknife(sums_, [this](double, std::span<const Complex> sums) {
    return std::vector<Complex>{contrast_of(sums[number_at].real(), sums[moments_at], squares_)};
  });
}

Estimate FieldStatistics::contrast() const {
  return jackknife(sums_, [this](double fields, std::span<const Complex> sums) {
    std::vector<Complex> contrast;
    for (const Complex moments : sums.last(intensity_.size()))
      contrast.emplace_back(contrast_of(fields, moments, squares_));
    return contrast;
  });
}

Estimate FieldStatistics::circularity() const {
  return jackknife(sums_, per_value(pseudo_at, 1));
}

Estimate FieldStatistics::histogram() const {
  return jackknife(sums_, per_value(histogram_at, bins));
}

Estimate FieldStatistics::autocorrelation() const {
  return jackknife(sums_, [this](double fields, std::span<const Complex> sums) {
    std::vector<Complex> mean(sums.begin() + lags_at, sums.begin() + lags_at + line_);
    for (Complex& value : mean) value /= fields;
    return mean;
  });
}

namespace {

/// Returns the lag at which a curve falls to half of its value at lag 0. Returns 0 if the curve
/// does not fall so far.
double half_lag(std::span<const Complex> curve) {
  const double half = curve.front().real() / 2;
  if (half <= 0) return 0;
  for (std::size_t d = 1; d < curve.size(); ++d) {
    const double before = curve[d - 1].real(), here = curve[d].real();
    if (here <= half) return static_cast<double>(d) - (half - here) / (before - here);
  }
  return 0;
}

}  // namespace

std::optional<Estimate> FieldStatistics::grain_width() const {
  Estimate width = jackknife(sums_, [this](double, std::span<const Complex> sums) {
    return std::vector<Complex>{2 * half_lag(sums.subspan(lags_at, line_))};
  });
  if (width.value.front().real() < 2) return std::nullopt;
  return width;
}

double FieldStatistics::values() const {
  return sums_.total()[number_at].real();
}

std::vector<double> FieldStatistics::exponential_law() {
  std::vector<double> shares;
  for (std::size_t i = 0; i < bins; ++i) {
    const double from = static_cast<double>(i) * bin_width;
    shares.push_back(i + 1 == bins ? std::exp(-from) : std::exp(-from) * -std::expm1(-bin_width));
  }
  return shares;
}

Estimate siegert_relation(const GroupedSums& sums, const Estimator& covariance, std::size_t views) {
  return jackknife(sums, [&](double samples, std::span<const Complex> total) {
    const auto lower = covariance(samples, total);
    const auto entry = [&](std::size_t a, std::size_t b) { return lower[triangle_entry(a, b)]; };
    std::vector<Complex> curve(views);
    for (std::size_t a = 0; a < views; ++a)
      for (std::size_t b = 0; b <= a; ++b)
        curve[a - b] += ratio(std::norm(entry(a, b)), entry(a, a).real() * entry(b, b).real()) /
                        static_cast<double>(views - (a - b));
    return curve;
  });
}

}  // namespace flatspeckle::mc
