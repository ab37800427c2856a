#include "grin/media/scattering/diffusion_rate.h"

#include <cmath>

namespace flatspeckle::grin {

CaseMode::CaseMode(double albedo, double g)
    : kappa_(diffusion_rate(albedo, g, 3)), g_(g), transport_length_(1 / (1 - g)) {
  constexpr int most = 1000;
  constexpr double negligible = 1e-14;
  std::vector<double> ratio(most + 2);  // psi_l / psi_(l-1), by downward recurrence
  for (int l = most; l >= 1; --l)
    ratio[l] = kappa_ * l /
               ((2 * l + 1) * (1 - albedo * std::pow(g, l)) - kappa_ * (l + 1) * ratio[l + 1]);
  double moment = 1;
  for (int l = 0; l <= most; ++l) {
    if (l > 0) moment *= ratio[l] * g;
    series_.push_back((2 * l + 1) * moment);
    more_.push_back(l / (l + 1.0));
    if (std::abs(series_.back()) < negligible) break;
  }
}

namespace {

/// Whether a rate r lies below the smallest root of the dispersion relation
///   h_0 = c_1 r^2 / (h_1 - c_2 r^2 / (h_2 - c_3 r^2 / ...)),  h_n = 1 - albedo g^n.
///
/// The relation states that the angular moments of the light decay with their order n. Flatland
/// uses Fourier moments, with c_1 = 1/2 and all other c_n = 1/4; space uses Legendre moments, with
/// c_n = n^2 / (4 n^2 - 1).
bool below_root(double albedo, double g, int dimension, double rate) {
  const auto share = [&](int n) {
    const double square = static_cast<double>(n) * n;
    return rate * rate * (dimension == 3 ? square / (4 * square - 1) : n == 1 ? 0.5 : 0.25);
  };
  // Value of the continued fraction beyond order 1000, where albedo g^n is neglected
  double tail = 1;
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
