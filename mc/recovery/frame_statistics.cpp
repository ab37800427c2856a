#include "mc/recovery/frame_statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.h"
#include "core/numbers/fourier.h"
#include "mc/speckle/field_statistics.h"

namespace flatspeckle::mc {

namespace {

/// What is averaged by: a Gaussian, or what keeps cubics as they are, but follows speckle more and
/// may even be negative.
enum class Envelope { gaussian, cubics };

/// Averages of lines with a Gaussian of this standard deviation; nothing comes from beyond the
/// ends.
class SmoothAverage {
 public:
  SmoothAverage(std::size_t pixels, double width, Envelope kind)
      : size_(transform_size(static_cast<double>(pixels) + 6 * width)),
        forward_(size_, LineTransform::Direction::forward),
        backward_(size_, LineTransform::Direction::backward),
        width_(width),
        kind_(kind) {}

  std::vector<double> operator()(std::span<const double> line) const {
    std::vector<Complex> padded(size_);
    std::copy(line.begin(), line.end(), padded.begin());
    forward_(padded.data());
    for (std::size_t m = 0; m < size_; ++m) {
      const double cycles =
          static_cast<double>(std::min(m, size_ - m)) / static_cast<double>(size_);
      const double turns = 2 * std::numbers::pi * cycles * width_;
      const double decay = turns * turns / 2;
      padded[m] *= std::exp(-decay) * (kind_ == Envelope::cubics ? 1 + decay : 1) /
                   static_cast<double>(size_);
    }
    backward_(padded.data());
    std::vector<double> averaged(line.size());
    for (std::size_t p = 0; p < line.size(); ++p) averaged[p] = padded[p].real();
    return averaged;
  }

 private:
  std::size_t size_;
  LineTransform forward_, backward_;
  double width_;
  Envelope kind_;
};

std::vector<double> envelope_of(std::span<const double> frame, double width, Envelope kind) {
  const SmoothAverage average(frame.size(), width, kind);
  auto envelope = average(frame);
  const auto whole = average(std::vector<double>(frame.size(), 1.0));
  for (std::size_t p = 0; p < frame.size(); ++p) envelope[p] /= whole[p];
  return envelope;
}

std::vector<double> over(std::span<const double> frame, std::span<const double> envelope) {
  std::vector<double> rest(frame.size());
  for (std::size_t p = 0; p < frame.size(); ++p) rest[p] = frame[p] / envelope[p] - 1;
  return rest;
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

/// The integral of the square of the normalised peak about lag 0, up to where it first falls to the
/// noise.
double central_peak(std::span<const double> autocorrelation, double noise) {
  double sum = 0.5;
  for (std::size_t lag = 1; lag < autocorrelation.size(); ++lag) {
    const double value = autocorrelation[lag] / autocorrelation[0];
    if (value < std::max(noise / autocorrelation[0], 0.02)) break;
    sum += value * value;
  }
  return 2 * sum;
}

}  // namespace

std::vector<double> without_envelope(std::span<const double> frame, double width) {
  const auto envelope = envelope_of(frame, width, Envelope::gaussian);
  for (std::size_t p = 0; p < frame.size(); ++p)
    if (!(envelope[p] > 0))
      throw InputError("the frame's mean about pixel " + std::to_string(p) + " is not positive");
  return over(frame, envelope);
}

double squared_contrast(std::span<const double> frame) {
  const std::size_t width = std::max<std::size_t>(frame.size() / 32, 1), margin = 4 * width;
  const auto by = [&](std::size_t one_width) {
    const auto w = static_cast<double>(one_width);
    auto envelope = envelope_of(frame, w, Envelope::cubics);
    if (!(*std::min_element(envelope.begin(), envelope.end()) > 0))  // of few and large grains
      envelope = envelope_of(frame, w, Envelope::gaussian);
    const auto rest = over(frame, envelope);
    const auto inner = std::span(rest).subspan(margin, rest.size() - 2 * margin);
    return std::inner_product(inner.begin(), inner.end(), inner.begin(), 0.0) /
           static_cast<double>(inner.size());
  };
  return 2 * by(2 * width) - by(width);
}

FrameStatistics frame_statistics(std::span<const double> frame, std::size_t lags,
                                 double noise_variance) {
  const auto rest = without_envelope(frame, 2.0 * static_cast<double>(lags));
  auto values = Autocorrelation(frame.size())(rest);
  FrameStatistics found;
  found.noise =
      standard_deviation(std::span(values).subspan(lags, std::min(lags, frame.size() - lags)));
  values.resize(lags);
  values[0] -= noise_variance;
  const double square = squared_contrast(frame) - noise_variance;
  found.contrast = std::sqrt(std::max(square, 0.0));
  found.grain = values[0] > 0 ? central_peak(values, found.noise) : 0;
  found.grains = found.grain > 0 ? static_cast<double>(frame.size()) / found.grain : 0;
  found.autocorrelation = std::move(values);
  return found;
}

}  // namespace flatspeckle::mc
