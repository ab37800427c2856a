#include "mc/imaging/recovery/deconvolution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/recovery/line_spectrum.h"

namespace flatspeckle::mc {

namespace {

std::vector<double> powers(std::span<const Complex> spectrum) {
  std::vector<double> power;
  for (const Complex& value : spectrum) power.push_back(std::norm(value));
  return power;
}

std::vector<double> wiener(std::span<const double> frame, std::span<const double> reference,
                           std::size_t lags, double regularisation, double width) {
  const LineSpectrum spectra(transform_size(static_cast<double>(frame.size() + lags)));
  auto picture = spectra.of(frame);
  const auto by = spectra.of(reference);
  const auto power = powers(by);
  const double noise = regularisation * typical_power(power) / 2;
  for (std::size_t m = 0; m < picture.size(); ++m)
    picture[m] = product(picture[m], std::conj(by[m])) *
                 (gaussian_spectrum(spectra.frequency(m), width) / (power[m] + noise));
  return about_zero(spectra.line(std::move(picture)), lags);
}

/// Richardson-Lucy iteration. The frame is modelled as the reference convolved with the object,
/// plus uniform light, all positive. Each step multiplies object and uniform light by factors that
/// follow from the ratio of frame and model. Frame and model are compared only in the inner part of
/// the frame, which the reference covers at all shifts.
class RichardsonLucy {
 public:
  RichardsonLucy(std::span<const double> frame, std::span<const double> reference, std::size_t lags)
      : lags_(lags),
        spectra_(transform_size(static_cast<double>(frame.size() + 2 * lags))),
        reference_(spectra_.of(reference)),
        frame_(frame),
        object_(2 * lags - 1, 0.5 / static_cast<double>(2 * lags - 1)) {}

  /// Performs one step. Returns the rms difference between frame and model before the step.
  double step() {
    const auto model = modelled();
    std::vector<double> ratio(frame_.size());
    double squares = 0, all = 0;
    for (std::size_t p = lags_; p < frame_.size() - lags_; ++p) {
      squares += (frame_[p] - model[p]) * (frame_[p] - model[p]);
      ratio[p] = frame_[p] / std::max(model[p], 1e-9);
      all += ratio[p];
    }
    const auto count = static_cast<double>(frame_.size() - 2 * lags_);
    multiply(ratio, count);
    even_ *= all / count;
    return std::sqrt(squares / count);
  }

  std::vector<double> picture(double width) const {
    auto spectrum = spectra_.of(object_);
    for (std::size_t m = 0; m < spectrum.size(); ++m)
      spectrum[m] *= gaussian_spectrum(spectra_.frequency(m), width);
    auto line = spectra_.line(std::move(spectrum));
    line.resize(object_.size());
    return line;
  }

 private:
  /// Returns the model of the frame. Element 0 of the object belongs to the shift -(lags - 1), so
  /// that the frame begins at element lags - 1 of the convolution.
  std::vector<double> modelled() const {
    auto spectrum = spectra_.of(object_);
    for (std::size_t m = 0; m < spectrum.size(); ++m)
      spectrum[m] = product(spectrum[m], reference_[m]);
    auto line = spectra_.line(std::move(spectrum));
    line.erase(line.begin(), line.begin() + static_cast<long>(lags_ - 1));
    line.resize(frame_.size());
    for (double& value : line) value += even_;
    return line;
  }
  void multiply(std::span<const double> ratio, double count) {
    auto spectrum = spectra_.of(ratio);
    for (std::size_t m = 0; m < spectrum.size(); ++m)
      spectrum[m] = product(spectrum[m], std::conj(reference_[m]));
    const auto correction = about_zero(spectra_.line(std::move(spectrum)), lags_);
    for (std::size_t i = 0; i < object_.size(); ++i)
      object_[i] *= std::max(correction[i], 0.0) / count;
  }

  std::size_t lags_;
  LineSpectrum spectra_;
  std::vector<Complex> reference_;
  std::span<const double> frame_;
  std::vector<double> object_;
  double even_ = 0.5;
};

std::vector<double> plus_one(std::vector<double> line) {
  // Values below 0 are due to read noise.
  for (double& value : line) value = std::max(value + 1, 0.0);
  return line;
}

}  // namespace

double typical_power(std::span<const double> power) {
  const double sum = std::reduce(power.begin(), power.end()),
               squares = std::inner_product(power.begin(), power.end(), power.begin(), 0.0);
  return sum > 0 ? squares / sum : 0;
}

Deconvolved deconvolved(std::span<const double> frame, std::span<const double> reference,
                        std::size_t lags, const DeconvolutionTask& task) {
  const auto envelope = 2.0 * static_cast<double>(lags);
  auto rest = without_envelope(frame, envelope), by = without_envelope(reference, envelope);
  Deconvolved found;
  found.grain = frame_statistics(reference, lags).grain;
  const double width = point_width(found.grain);
  if (task.method == DeconvolutionTask::Method::wiener) {
    found.picture = wiener(rest, by, lags, task.regularisation, width);
    return found;
  }
  rest = plus_one(std::move(rest));
  by = plus_one(std::move(by));
  RichardsonLucy iteration(rest, by, lags);
  for (std::int64_t i = 0; i < task.iterations; ++i) found.residual.push_back(iteration.step());
  found.picture = iteration.picture(width);
  return found;
}

std::vector<double> point_picture(const LineObject& shifts, std::size_t lags, double grain) {
  const double width = point_width(grain),
               all = std::reduce(shifts.brightness.begin(), shifts.brightness.end());
  std::vector<double> picture(2 * lags - 1);
  for (std::size_t i = 0; i < shifts.x.size(); ++i)
    for (std::size_t p = 0; p < picture.size(); ++p) {
      const double off =
          (static_cast<double>(p) - static_cast<double>(lags - 1) - shifts.x[i]) / width;
      picture[p] += shifts.brightness[i] / all * std::exp(-off * off / 2) /
                    (width * std::sqrt(2 * std::numbers::pi));
    }
  return picture;
}

double psnr(std::span<const double> truth, std::span<const double> picture, double noise) {
  double both = 0, squares = 0, own = 0;
  for (std::size_t p = 0; p < truth.size(); ++p) {
    both += truth[p] * picture[p];
    squares += picture[p] * picture[p];
    own += truth[p] * truth[p];
  }
  squares += noise * static_cast<double>(truth.size());
  constexpr double rounding = 1e-14;
  const double like = squares > 0 && both > 0 ? both * both / squares : 0,
               left = std::max(own - like, rounding * own);
  const double largest = *std::max_element(truth.begin(), truth.end());
  return 10 * std::log10(largest * largest * static_cast<double>(truth.size()) / left);
}

}  // namespace flatspeckle::mc
