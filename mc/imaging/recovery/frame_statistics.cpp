#include "mc/imaging/recovery/frame_statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "mc/imaging/recovery/line_spectrum.h"
#include "mc/imaging/recovery/pair_peaks.h"
#include "mc/paths/speckle/field_statistics.h"

namespace flatspeckle::mc {

namespace {

/// What is averaged by: a Gaussian, or what keeps cubics as they are, but follows speckle more and
/// may even be negative.
enum class Envelope { gaussian, cubics };

/// Averages of a line; nothing comes from beyond the ends.
std::vector<double> averaged(const LineSpectrum& spectra, std::span<const double> line,
                             double width, Envelope kind) {
  auto spectrum = spectra.of(line);
  for (std::size_t m = 0; m < spectrum.size(); ++m) {
    const double gaussian = gaussian_spectrum(spectra.frequency(m), width);
    spectrum[m] *=
        kind == Envelope::cubics && gaussian > 0 ? gaussian * (1 - std::log(gaussian)) : gaussian;
  }
  auto average = spectra.line(std::move(spectrum));
  average.resize(line.size());
  return average;
}

std::vector<double> envelope_of(std::span<const double> frame, double width, Envelope kind) {
  const LineSpectrum spectra(transform_size(static_cast<double>(frame.size()) + 6 * width));
  auto envelope = averaged(spectra, frame, width, kind);
  const auto whole = averaged(spectra, std::vector<double>(frame.size(), 1.0), width, kind);
  for (std::size_t p = 0; p < frame.size(); ++p) envelope[p] /= whole[p];
  return envelope;
}

std::vector<double> over(std::span<const double> frame, std::span<const double> envelope) {
  std::vector<double> rest(frame.size());
  for (std::size_t p = 0; p < frame.size(); ++p) rest[p] = frame[p] / envelope[p] - 1;
  return rest;
}

/// Mean of what the camera adds to the variance of a frame over its envelope, at these pixels.
double mean_noise(std::span<const double> envelope, double mean, const CameraNoise& noise) {
  double sum = 0;
  for (const double value : envelope) sum += noise_variance(noise, value / mean);
  return sum / static_cast<double>(envelope.size());
}

double mean_of(std::span<const double> values) {
  return std::reduce(values.begin(), values.end()) / static_cast<double>(values.size());
}

std::vector<double> positive_envelope(std::span<const double> frame, double width) {
  auto envelope = envelope_of(frame, width, Envelope::gaussian);
  for (std::size_t p = 0; p < frame.size(); ++p)
    if (!(envelope[p] > 0))
      throw InputError("the frame's mean about pixel " + std::to_string(p) + " is not positive");
  return envelope;
}

double standard_deviation(std::span<const double> values) {
  double sum = 0, squares = 0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(values.size());
  return std::sqrt(std::max(squares / n - sum / n * sum / n, 0.0));
}

}  // namespace

std::vector<double> without_envelope(std::span<const double> frame, double width) {
  return over(frame, positive_envelope(frame, width));
}

double envelope_width(std::size_t pixels, std::size_t lags) {
  constexpr std::size_t least = 32;
  return static_cast<double>(std::min(2 * lags, std::max(pixels / 32, least)));
}

double squared_contrast(std::span<const double> frame, std::size_t lags, const CameraNoise& noise) {
  const std::size_t narrow = std::max<std::size_t>(frame.size() / 32, 1),
                    width = std::clamp(lags, narrow, 2 * narrow), margin = 4 * width;
  const auto inner = [margin](std::span<const double> line) {
    return line.subspan(margin, line.size() - 2 * margin);
  };
  const auto by = [&](std::size_t one_width) {
    const auto w = static_cast<double>(one_width);
    auto envelope = envelope_of(frame, w, Envelope::cubics);
    if (!(*std::min_element(envelope.begin(), envelope.end()) > 0))  // of few and large grains
      envelope = envelope_of(frame, w, Envelope::gaussian);
    const auto rest = over(frame, envelope);
    const auto seen = inner(rest);
    return std::inner_product(seen.begin(), seen.end(), seen.begin(), 0.0) /
               static_cast<double>(seen.size()) -
           mean_noise(inner(envelope), mean_of(frame), noise);
  };
  return 2 * by(2 * width) - by(width);
}

FrameStatistics frame_statistics(std::span<const std::vector<double>> frames, std::size_t lags,
                                 const CameraNoise& noise) {
  const std::size_t pixels = frames.front().size();
  const auto count = static_cast<double>(frames.size());
  const Autocorrelation autocorrelation(pixels);
  std::vector<double> values(pixels);
  FrameStatistics found;
  double white = 0;
  for (const auto& frame : frames) {
    const auto envelope = positive_envelope(frame, envelope_width(pixels, lags));
    const auto own = autocorrelation(over(frame, envelope));
    for (std::size_t lag = 0; lag < pixels; ++lag) values[lag] += own[lag] / count;
    white += mean_noise(envelope, mean_of(frame), noise) / count;
    found.square += squared_contrast(frame, lags, noise) / count;
  }
  found.noise = standard_deviation(std::span(values).subspan(lags, std::min(lags, pixels - lags)));
  values[0] -= white;
  found.contrast = std::sqrt(std::max(found.square, 0.0));
  const double band = fitted_band(std::span(values).first(lags), found.noise, white);
  if (band > 0) {
    found.grain = grain_of(band);
    found.grains = static_cast<double>(pixels) * count / found.grain;
    found.peaks = pair_peaks(values, lags, {std::max(values[0], 0.0), white, band});
  }
  values.resize(lags);
  found.autocorrelation = std::move(values);
  return found;
}

FrameStatistics frame_statistics(std::span<const double> frame, std::size_t lags,
                                 const CameraNoise& noise) {
  const std::vector<double> one(frame.begin(), frame.end());
  return frame_statistics(std::span(&one, 1), lags, noise);
}

}  // namespace flatspeckle::mc
