#include "mc/recovery/speckle_band.h"

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

/// Of the main lobe: the part of an autocorrelation along a peak of unit norm.
double part_along(std::span<const double> autocorrelation, double band) {
  double product = autocorrelation[0] / 2, square = 0.5;
  for (std::size_t lag = 1; lag < autocorrelation.size() && static_cast<double>(lag) * band < 1;
       ++lag) {
    const double peak = speckle_peak(static_cast<double>(lag), band);
    product += autocorrelation[lag] * peak;
    square += peak * peak;
  }
  return product / std::sqrt(square);
}

}  // namespace

double fitted_band(std::span<const double> autocorrelation) {
  constexpr double finer = 1.02;
  double found = 0, most = 0;
  for (double band = 1; band * static_cast<double>(autocorrelation.size()) > 4; band /= finer)
    if (const double part = part_along(autocorrelation, band); part > most) {
      most = part;
      found = band;
    }
  return found;
}

}  // namespace flatspeckle::mc
