#include "mc/imaging/pair_signals.h"

#include <cmath>
#include <numeric>

#include "mc/imaging/recovery/speckle_band.h"

namespace flatspeckle::mc {

namespace {

/// Of an autocorrelation without noise.
struct Peaks {
  std::vector<double> pairs;
  double alone = 0, squares = 0;  ///< a_0; 2 sum of a_ij^2

  Peaks(const LineObject& object, const std::vector<double>& correlation, double background) {
    const std::vector<double>& b = object.brightness;
    const double all = std::reduce(b.begin(), b.end()) * (1 + background);
    alone = std::inner_product(b.begin(), b.end(), b.begin(), 0.0) / (all * all);
    for (std::size_t i = 0; i < b.size(); ++i)
      for (std::size_t j = i + 1; j < b.size(); ++j)
        pairs.push_back(correlation[pairs.size()] * b[i] * b[j] / (all * all));
    squares = 2 * std::inner_product(pairs.begin(), pairs.end(), pairs.begin(), 0.0);
  }
};

std::vector<double> over(std::vector<double> peaks, double variance) {
  for (double& peak : peaks) peak /= std::sqrt(variance);
  return peaks;
}

}  // namespace

std::vector<double> peaks_over_noise(const LineObject& object,
                                     const std::vector<double>& correlation,
                                     const FrameGrains& frame) {
  const Peaks peaks(object, correlation, frame.noise.background);
  const double white = noise_variance(frame.noise);
  return over(peaks.pairs, (peaks.alone * peaks.alone + peaks.squares) / frame.grains +
                               (2 * peaks.alone + white) * white / frame.pixels);
}

std::vector<double> filtered_peaks_over_noise(const LineObject& object,
                                              const std::vector<double>& correlation,
                                              const FrameGrains& frame, double band) {
  const Peaks peaks(object, correlation, frame.noise.background);
  const double white = noise_variance(frame.noise);
  double variance = 0, kept = 0;
  constexpr int frequencies = 2000;
  for (int i = 0; i < frequencies; ++i) {
    const double speckle = speckle_power((i + 0.5) / (2 * frequencies), band);
    if (speckle == 0) continue;
    const double power = peaks.alone * speckle + white, filter = speckle / power;
    kept += filter * speckle / frequencies;
    variance += filter * filter * (power * power + peaks.squares * speckle * speckle) / frequencies;
  }
  return over(peaks.pairs, variance / (kept * kept) / frame.pixels);
}

}  // namespace flatspeckle::mc
