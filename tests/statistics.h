#pragma once

#include <cmath>
#include <vector>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <doctest/doctest.h>

namespace flatspeckle::tests {

/// Chance that a correct library fails any of its chi-square tests at fresh seeds, and how many
/// such tests there are (rounded up): each is held to the Sidak share.
inline constexpr double suite_significance = 1e-3;
inline constexpr int suite_size = 50;

/// Counts against the probabilities of the bins; neighbours are merged until each expects 5.
struct ChiSquare {
  double statistic = 0;
  int degrees = 0;

  ChiSquare(const std::vector<double>& counts, const std::vector<double>& probabilities) {
    struct Bin {
      double observed = 0, expected = 0;
    };
    double total = 0;
    for (double count : counts) total += count;
    std::vector<Bin> bins(1);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (bins.back().expected >= 5) bins.emplace_back();
      bins.back().observed += counts[i];
      bins.back().expected += total * probabilities[i];
    }
    if (bins.size() > 1 && bins.back().expected < 5) {
      const Bin rest = bins.back();
      bins.pop_back();
      bins.back().observed += rest.observed;
      bins.back().expected += rest.expected;
    }
    for (const Bin& bin : bins)
      statistic += (bin.observed - bin.expected) * (bin.observed - bin.expected) / bin.expected;
    degrees = static_cast<int>(bins.size()) - 1;
  }

  double limit() const {
    const double share = 1 - std::pow(1 - suite_significance, 1.0 / suite_size);
    return quantile(complement(boost::math::chi_squared(degrees), share));
  }
};

/// The probabilities must be those of all that was counted.
inline void check_chi_square(const std::vector<double>& counts,
                             const std::vector<double>& probabilities) {
  double sum = 0;
  for (double p : probabilities) sum += p;
  CHECK(sum == doctest::Approx(1).epsilon(1e-3));
  const ChiSquare test(counts, probabilities);
  REQUIRE(test.degrees >= 5);
  CHECK(test.statistic < test.limit());
}

/// Integral by adaptive Gauss-Kronrod quadrature, to a relative 1e-10 or so.
template <typename F>
double integral(F f, double from, double to) {
  return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(f, from, to, 12, 1e-11);
}

}  // namespace flatspeckle::tests
