#include "wave_solver/equations/multipole_ring.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numbers/bessel.h"

namespace flatspeckle::wave {

namespace {

constexpr long double infinity = std::numeric_limits<long double>::infinity();

// weight / J_n(k rho), n = 0 .. order: what must stay moderate, away from interior resonances.
std::vector<long double> amplitudes(const ModeSet& modes, double k, double rho) {
  const auto j = bessel_j(modes.order, k * rho);
  std::vector<long double> result(modes.order + 1, 0);
  for (const Mode& mode : modes.modes) {
    const long double size = std::abs(j[mode.order]);
    result[mode.order] =
        size > 0 ? 2 * root_half * static_cast<long double>(mode.weight) / size : infinity;
  }
  return result;
}

// 0 where charges leave the range of numbers on every circle.
double best_radius(const ModeSet& modes, double k, double disk) {
  constexpr int tries = 32;
  double best = 0;
  long double least = infinity;
  for (int i = 0; i < tries; ++i) {
    const double rho = disk * (1 - 0.5 * i / tries);
    const auto found = amplitudes(modes, k, rho);
    const long double largest = *std::max_element(found.begin(), found.end());
    if (largest < least) {
      least = largest;
      best = rho;
    }
  }
  return best;
}

// Fewest points for which every order n leaves little of its first alias Q - n at the distance; 0
// where telling leaves the range of numbers.
std::size_t enough_points(const ModeSet& modes, double k, double rho, double distance,
                          double tolerance) {
  const auto strength = amplitudes(modes, k, rho);
  for (int last = 2 * modes.order + 64;; last *= 2) {
    const auto j = bessel_j(last, k * rho);
    const auto h = hankel(last, k * distance);
    for (int q = 2 * modes.order + 2; q <= last; q += 2) {
      long double worst = 0;
      for (int n = 0; n <= modes.order; ++n) {
        const long double alias = strength[n] * std::abs(j[q - n]) * std::abs(h[q - n]);
        if (!std::isfinite(alias)) return 0;
        worst = std::max(worst, alias);
      }
      if (worst < tolerance) return q;
    }
  }
}

}  // namespace

MultipoleRing::MultipoleRing(const ModeSet& modes, double k, double disk, double distance,
                             double tolerance) {
  if (modes.order > 0) {
    if (std::isfinite(distance)) radius = best_radius(modes, k, disk);
    points = radius > 0 ? enough_points(modes, k, radius, distance, tolerance) : 0;
    if (points == 0) {
      largest_charge = std::numeric_limits<double>::infinity();
      return;
    }
  }
  const auto j = radius > 0 ? bessel_j(modes.order, k * radius) : std::vector<long double>{1};
  charges.resize(modes.modes.size() * points);
  for (std::size_t m = 0; m < modes.modes.size(); ++m) {
    const Mode& mode = modes.modes[m];
    const auto each =
        static_cast<double>(2 * root_half * static_cast<long double>(mode.weight) / j[mode.order]) /
        static_cast<double>(points);
    largest_charge = std::max(largest_charge, std::abs(each) * static_cast<double>(points));
    for (std::size_t s = 0; s < points; ++s) {
      const double angle =
          mode.order * 2 * std::numbers::pi * static_cast<double>(s) / static_cast<double>(points);
      charges[m * points + s] = each * (mode.odd ? std::sin(angle) : std::cos(angle));
    }
  }
}

Vec2 MultipoleRing::position(std::size_t point) const {
  return radius *
         direction(2 * std::numbers::pi * static_cast<double>(point) / static_cast<double>(points));
}

}  // namespace flatspeckle::wave
