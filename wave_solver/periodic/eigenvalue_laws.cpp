#include "wave_solver/periodic/eigenvalue_laws.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/numbers/complex.h"
#include "core/numbers/gauss.h"

namespace flatspeckle::wave {

namespace {

// Resolvent of t^H t, the mean of 1 / (z - tau), of all channels and of a part of them.
class Resolvent {
 public:
  // part: fraction of the channels that is kept. The mean of the bimodal law is s tanh(1/s).
  Resolvent(double mean_transmittance, double part) : part_(part), s_(mean_transmittance) {
    for (int step = 0; step < 100; ++step) s_ = mean_transmittance / std::tanh(1 / s_);
  }

  Complex whole(Complex z) const {
    const Complex root = std::sqrt(1.0 - z);
    return 1.0 / z - s_ / (z * root) * std::atanh(std::tanh(1 / s_) / root);
  }

  // Solves the implicit equation of the filtered resolvent by Newton's method, from 1/z far from
  // the real axis down to it.
  Complex filtered(double tau) const {
    constexpr double first = 5, last = 1e-6;
    constexpr int levels = 100;
    Complex found = 1.0 / Complex(tau, first);
    for (int level = 0; level < levels; ++level)
      found = root(found, {tau, first * std::pow(last / first, level / (levels - 1.0))});
    return found;
  }

 private:
  Complex mismatch(Complex g, Complex z) const {
    const Complex n = z * part_ * g + 1.0 - part_, d = part_ * g * z * part_ * g;
    return n / d * whole(n * n / d) - 1.0;
  }
  Complex root(Complex g, Complex z) const {
    for (int step = 0; step < 30; ++step) {
      const Complex here = mismatch(g, z), shift = 1e-6 * g;
      Complex change = here * shift / (mismatch(g + shift, z) - here);
      const double size = std::abs(change) / std::abs(g);
      if (size > 0.3) change *= 0.3 / size;
      g -= change;
      if (size < 1e-12) break;
    }
    return g;
  }

  double part_, s_;
};

}  // namespace

std::vector<double> bimodal_counts(double g, std::size_t n, std::size_t bins) {
  const auto above = [&](double value) {  // number of eigenvalues above a value
    return value <= 0 ? static_cast<double>(n)
                      : std::min(static_cast<double>(n), g * std::acosh(1 / std::sqrt(value)));
  };
  std::vector<double> counts;
  for (std::size_t i = 0; i < bins; ++i)
    counts.push_back(above(static_cast<double>(i) / static_cast<double>(bins)) -
                     above(static_cast<double>(i + 1) / static_cast<double>(bins)));
  return counts;
}

// The first bin contains the eigenvalues that are not in the others.
std::vector<double> filtered_counts(double g, std::size_t n, std::size_t kept, std::size_t bins) {
  if (kept == n) return bimodal_counts(g, n, bins);
  const auto all = static_cast<double>(n), some = static_cast<double>(kept);
  const Resolvent resolvent(g / all, some / all);
  const auto rule = gauss_legendre(16);
  std::vector<double> counts(bins);
  for (std::size_t bin = 1; bin < bins; ++bin)
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const double tau = (static_cast<double>(bin) + rule.node[i]) / static_cast<double>(bins);
      counts[bin] -= rule.weight[i] * some / static_cast<double>(bins) / std::numbers::pi *
                     resolvent.filtered(tau).imag();
    }
  counts[0] = some - std::accumulate(counts.begin(), counts.end(), 0.0);
  return counts;
}

}  // namespace flatspeckle::wave
