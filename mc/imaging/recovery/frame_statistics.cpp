#include "mc/imaging/recovery/frame_statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.h"
#include "mc/imaging/recovery/line_spectrum.h"
#include "mc/paths/speckle/field_statistics.h"

namespace flatspeckle::mc {

double speckle_peak(double lag, double band) {
  const double turns = std::numbers::pi * band * lag;
  if (std::abs(turns) < 1e-6) return 1;
  const double sinc = std::sin(turns) / turns;
  return sinc * sinc;
}

double speckle_power(double frequency, double band) {
  double power = 0;
  for (int fold = -2; fold <= 2; ++fold)
    power += std::max(1 - std::abs(frequency + fold) / band, 0.0) / band;
  return power;
}

double grain_of(double band) {
  double sum = 0;
  for (int lag = 1; lag < 3 / band; ++lag) sum += std::pow(speckle_peak(lag, band), 2);
  return 1 + 2 * sum;
}

double mean_of(std::span<const double> values) {
  return std::reduce(values.begin(), values.end()) / static_cast<double>(values.size());
}

namespace {

/// Fit of speckle_peak() to an autocorrelation, from which its mean beside the main lobe is first
/// subtracted.
struct PeakFit {
  double height = 0;
  double part = 0;  ///< height / its standard deviation, for noise of variance 1 at each lag
};

PeakFit fitted_peak(std::span<const double> autocorrelation, double band, double white) {
  constexpr std::size_t least = 64;
  const double at_zero = 1 / (1 + white / 2);
  double product = at_zero * autocorrelation[0] / 2, square = at_zero / 2, sum = at_zero / 2;
  double beside = 0, count = 0;
  for (std::size_t lag = 1; lag < autocorrelation.size(); ++lag) {
    const double lobes = static_cast<double>(lag) * band;
    if (lobes < 1) {
      const double peak = speckle_peak(static_cast<double>(lag), band);
      product += autocorrelation[lag] * peak;
      square += peak * peak;
      sum += peak;
    } else if (lobes < 6 || lag < least) {
      beside += autocorrelation[lag];
      ++count;
    }
  }
  const double own = product - sum * beside / count, norm = square + sum * sum / count;
  return {own / norm, own / std::sqrt(norm)};
}

/// Appends the mirror image of a line, so that the result is even and periodic.
std::vector<double> both_sides(std::span<const double> line) {
  std::vector<double> both(line.begin(), line.end());
  both.insert(both.end(), line.rbegin() + 1, line.rend() - 1);
  return both;
}

/// Filter as a function of frequency. It does not change the height of the peak of a pair.
struct Filter {
  std::vector<double> spectrum;
  double width = 0;  ///< width of a filtered peak in pixels
};

Filter filter_of(const LineSpectrum& spectra, const AutocorrelationTerms& terms) {
  std::vector<double> filter(spectra.size());
  double kept = 0, squares = 0;
  for (std::size_t m = 0; m < filter.size(); ++m) {
    const double speckle = speckle_power(spectra.frequency(m), terms.band),
                 power = terms.alone * speckle + terms.white;
    filter[m] = power > 0 ? speckle / power : 0;
    kept += filter[m] * speckle / static_cast<double>(filter.size());
    squares += std::pow(filter[m] * speckle, 2) / static_cast<double>(filter.size());
  }
  for (double& value : filter) value /= kept;
  return {std::move(filter), squares / (kept * kept)};
}

/// Resamples a line, given by its spectrum, to another number of values. Only frequencies below
/// both Nyquist frequencies are used.
std::vector<double> resampled(std::span<const Complex> spectrum, std::size_t size) {
  std::vector<Complex> part(size);
  const std::size_t half = (std::min(size, spectrum.size()) - 1) / 2;
  part[0] = spectrum[0];
  for (std::size_t m = 1; m <= half; ++m) {
    part[m] = spectrum[m];
    part[size - m] = spectrum[spectrum.size() - m];
  }
  auto line = LineSpectrum(size).line(std::move(part));
  const double scale = static_cast<double>(size) / static_cast<double>(spectrum.size());
  for (double& value : line) value *= scale;
  return line;
}

double rms(std::span<const double> values) {
  double squares = 0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

/// Kernel of the moving average: a Gaussian, or a kernel that preserves cubic polynomials but
/// follows speckle more closely and may give negative values.
enum class Envelope { gaussian, cubics };

/// Returns moving averages of a line; values beyond its ends count as 0.
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

/// Returns the contribution of the camera's noise to the variance of a frame divided by its
/// envelope, averaged over the pixels of `envelope`.
double mean_noise(std::span<const double> envelope, double mean, const CameraNoise& noise) {
  double sum = 0;
  for (const double value : envelope) sum += noise_variance(noise, value / mean);
  return sum / static_cast<double>(envelope.size());
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

double fitted_band(std::span<const double> autocorrelation, double noise, double white) {
  constexpr double finer = 1.02;
  const double height = (autocorrelation[0] - 4 * noise * std::sqrt(2 + white)) / 2;
  double found = 0, most = 0;
  for (double band = 1; band * static_cast<double>(autocorrelation.size()) > 4; band /= finer)
    if (const PeakFit fit = fitted_peak(autocorrelation, band, white);
        fit.part > most && fit.height > height) {
      most = fit.part;
      found = band;
    }
  return found;
}

PairPeaks pair_peaks(std::span<const double> autocorrelation, std::size_t lags,
                     const AutocorrelationTerms& terms) {
  const std::size_t known = std::min(2 * lags, autocorrelation.size());
  std::vector<double> pairs(autocorrelation.begin(),
                            autocorrelation.begin() + static_cast<long>(known));
  for (std::size_t lag = 0; lag < known; ++lag)
    pairs[lag] -= terms.alone * speckle_peak(static_cast<double>(lag), terms.band);
  const auto line = both_sides(pairs);
  const LineSpectrum spectra(line.size());
  auto spectrum = spectra.of(line);
  const auto filter = filter_of(spectra, terms);
  for (std::size_t m = 0; m < spectrum.size(); ++m) spectrum[m] *= filter.spectrum[m];

  const double finest = 0.5, target_step = std::max(grain_of(terms.band) / 3, finest),
               length = static_cast<double>(line.size());
  const std::size_t size = transform_size(length / target_step);
  PairPeaks peaks;
  peaks.step = length / static_cast<double>(size);
  peaks.alone = terms.alone;
  peaks.width = filter.width;
  peaks.height = resampled(spectrum, size);
  const auto in_steps = [&](std::size_t pixels) {
    return static_cast<std::size_t>(static_cast<double>(pixels) / peaks.step);
  };
  const std::size_t inside = in_steps(lags), beyond = std::min(in_steps(known), size / 2);
  const auto noise_only = std::span(peaks.height).subspan(inside, beyond - inside);
  const double mean =
      std::reduce(noise_only.begin(), noise_only.end()) / static_cast<double>(noise_only.size());
  for (double& height : peaks.height)
    height -= mean;  // removes the offset that the division by the envelope introduces
  peaks.noise = rms(noise_only);
  peaks.height.resize(inside);
  return peaks;
}

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
    // An envelope that is not positive occurs if grains are few and large.
    if (!(*std::min_element(envelope.begin(), envelope.end()) > 0))
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
  double white = 0, variance = 0;
  for (const auto& frame : frames) {
    const auto envelope = positive_envelope(frame, envelope_width(pixels, lags));
    const auto fluctuation = over(frame, envelope);
    const auto own = autocorrelation(fluctuation);
    variance += std::pow(rms(fluctuation), 2) / count;
    for (std::size_t lag = 0; lag < pixels; ++lag) values[lag] += own[lag] / count;
    white += mean_noise(envelope, mean_of(frame), noise) / count;
    found.square += squared_contrast(frame, lags, noise) / count;
  }
  found.noise = standard_deviation(std::span(values).subspan(lags, std::min(lags, pixels - lags)));
  constexpr double rounding = 1e-10;
  if (variance > 0) found.variance = {std::abs(values[0] / variance - 1), rounding};
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
