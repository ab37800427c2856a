#include "grin/media/scattering/diffusion_rate.h"

#include <algorithm>
#include <cmath>

namespace flatspeckle::grin {

namespace {

/// Dispersion relation of the rate r,
///   h_0 = c_1 r^2 / (h_1 - c_2 r^2 / (h_2 - c_3 r^2 / ...)),  h_n = 1 - albedo g^n.
///
/// The relation states that the angular moments of the light decay with their order n. Flatland
/// uses Fourier moments, with c_1 = 1/2 and all other c_n = 1/4; space uses Legendre moments, with
/// c_n = n^2 / (4 n^2 - 1).
class DispersionRelation {
 public:
  DispersionRelation(double albedo, double g, int dimension) : dimension_(dimension) {
    for (int n = 0; n <= orders; ++n) losses_.push_back(1 - albedo * std::pow(g, n));
  }

  /// Number of roots below a rate: that of negative pivots in the factorisation of the tridiagonal
  /// system of the moments (Sylvester's law of inertia).
  int roots_below(double rate) const {
    int negative = 0;
    double pivot = 1;  // beyond the last order, where albedo g^n is neglected
    for (int n = orders; n >= 0; --n) {
      pivot = losses_[n] - share(n + 1) * rate * rate / pivot;
      if (pivot < 0) ++negative;
    }
    return negative;
  }
  /// Returns a root, by its number from 0, by bisection.
  double root(int number) const {
    double low = 0, high = 1;
    for (int step = 0; step < 60; ++step) {
      const double middle = (low + high) / 2;
      (roots_below(middle) > number ? high : low) = middle;
    }
    return low;
  }

 private:
  static constexpr int orders = 1000;

  double share(int n) const {
    const double square = static_cast<double>(n) * n;
    return dimension_ == 3 ? square / (4 * square - 1) : n == 1 ? 0.5 : 0.25;
  }

  int dimension_;
  std::vector<double> losses_;  ///< h_n
};

}  // namespace

double diffusion_rate(double albedo, double g, int dimension) {
  return albedo >= 1 ? 0 : DispersionRelation(albedo, g, dimension).root(0);
}

std::vector<double> discrete_rates(double albedo, double g, int dimension, int count,
                                   double highest) {
  const DispersionRelation relation(albedo, g, dimension);
  std::vector<double> rates{albedo >= 1 ? 0 : relation.root(0)};
  const int all = std::min(count, relation.roots_below(highest));
  for (int number = 1; number < all; ++number) rates.push_back(relation.root(number));
  return rates;
}

}  // namespace flatspeckle::grin
