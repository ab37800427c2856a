#include "tests/statistics.h"

#include <cmath>
#include <cstdlib>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>

namespace flatspeckle::tests {

ChiSquare::ChiSquare(const std::vector<double>& counts, const std::vector<double>& probabilities) {
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

double ChiSquare::limit() const {
  const double share = 1 - std::pow(1 - suite_significance, 1.0 / suite_size);
  return quantile(complement(boost::math::chi_squared(degrees), share));
}

void check_chi_square(const std::vector<double>& counts, const std::vector<double>& probabilities) {
  double sum = 0;
  for (double p : probabilities) sum += p;
  CHECK(sum == doctest::Approx(1).epsilon(1e-3));
  const ChiSquare test(counts, probabilities);
  REQUIRE(test.degrees >= 5);
  CHECK(test.statistic < test.limit());
}

std::uint64_t fresh_seed(std::uint64_t number) {
  const char* moved = std::getenv("FLATSPECKLE_TEST_SEED");
  return number + (moved ? 1'000'003 * std::strtoull(moved, nullptr, 10) : 0);
}

Effort effort() {
  return is_night ? Effort{1, 1} : Effort{};
}

double integral(const std::function<double(double)>& f, double from, double to) {
  return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(f, from, to, 12, 1e-11);
}

}  // namespace flatspeckle::tests
