#include "mc/theory/diffusing_waves.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle::mc {

double diffusing_wave_correlation(const DiffusingSlab& slab, double delay, ExitSide side) {
  const double source = std::min(slab.transport_length, slab.thickness),
               height = side == ExitSide::transmitted ? source : slab.thickness - source,
               z0 = slab.extrapolation;
  // Returns log f of C53. Q is set to at least 1e-5 / thickness; below this value f equals its
  // limit at Q = 0 to rounding.
  const auto log_f = [&](double q2) {
    const double q = std::max(std::sqrt(q2), 1e-5 / slab.thickness), h = q * z0;
    return std::log(2 * h - (1 - h) * std::expm1(-2 * q * height)) -
           std::log(4 * h - (1 - h) * (1 - h) * std::expm1(-2 * q * slab.thickness)) -
           q * (slab.thickness - height);
  };
  const double kappa2 = slab.loss(slab.mu_a), loss = 2 * delay * (1 - slab.g) * slab.mu_s;
  return std::exp(log_f(kappa2 + slab.loss(loss)) - log_f(kappa2));
}

double backscattering_factor(const DiffusingSlab& slab) {
  return 1 + slab.extrapolation / slab.transport_length;
}

double diffusing_wave_decay(const DiffusingSlab& slab, ExitSide side) {
  const auto above = [&](double delay) {
    return diffusing_wave_correlation(slab, delay, side) > std::exp(-1);
  };
  double low = 0, high = 1e-6;
  while (above(high)) high *= 4;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (above(middle) ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace flatspeckle::mc
