#include "mc/imaging/recovery/speckle_band.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

namespace {

/// An autocorrelation along a peak, of which what stands beside the main lobe is taken off.
struct PeakFit {
  double height = 0;
  double part = 0;  ///< over its standard deviation where all lags have one of 1
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

}  // namespace flatspeckle::mc
