#include "grin/media/scattering/diffusion_rate.h"

#include <cmath>

namespace flatspeckle::grin {

namespace {

/// Whether a rate lies below the smallest root of the dispersion relation
///   h_0 = c_1 r^2 / (h_1 - c_2 r^2 / (h_2 - c_3 r^2 / ...)),  h_n = 1 - albedo g^n,
/// the condition that the moments of the angle decay: in flatland those of Fourier, c_n = 1/4 but
/// c_1 = 1/2, in space those of Legendre, c_n = n^2 / (4 n^2 - 1).
bool below_root(double albedo, double g, int dimension, double rate) {
  const auto share = [&](int n) {
    const double square = static_cast<double>(n) * n;
    return rate * rate * (dimension == 3 ? square / (4 * square - 1) : n == 1 ? 0.5 : 0.25);
  };
  double tail = 1;  // of high moments, which scattering does not feed
  for (int n = 1000; n >= 1; --n) {
    tail = 1 - albedo * std::pow(g, n) - share(n + 1) / tail;
    if (tail <= 0) return false;
  }
  return 1 - albedo > share(1) / tail;
}

}  // namespace

double diffusion_rate(double albedo, double g, int dimension) {
  if (albedo >= 1) return 0;
  double low = 0, high = 1;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (below_root(albedo, g, dimension, middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace flatspeckle::grin
