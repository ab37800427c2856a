#pragma once

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <vector>

#include <doctest/doctest.h>

namespace flatspeckle::tests {

/// Probability that a correct library fails any of its chi-square tests with fresh seeds, and the
/// number of such tests (rounded up), which determines the Sidak level of each.
inline constexpr double suite_significance = 1e-3;
inline constexpr int suite_size = 50;

/// Chi-square test of counts with the probabilities of the bins; neighbours are merged until each
/// expects 5.
struct ChiSquare {
  double statistic = 0;
  int degrees = 0;

  ChiSquare(const std::vector<double>& counts, const std::vector<double>& probabilities);

  double limit() const;
};

/// Checks counts; the probabilities must sum to 1.
void check_chi_square(const std::vector<double>& counts, const std::vector<double>& probabilities);

/// Returns the seed with this number, or a fresh one if FLATSPECKLE_TEST_SEED is set
/// (scripts/check.sh).
std::uint64_t fresh_seed(std::uint64_t number);

/// Whether tests use all of their samples and cases (FLATSPECKLE_TEST_WHOLE is set), as in nightly
/// runs.
inline const bool is_night = std::getenv("FLATSPECKLE_TEST_WHOLE") != nullptr;

/// Fraction of the samples that long tests use, a quarter by day, and the factor by which their
/// errors may grow.
struct Effort {
  double samples = 0.25, errors = 2;
};
Effort effort();

/// Integrates by adaptive Gauss-Kronrod quadrature, to a relative error of about 1e-10.
double integral(const std::function<double(double)>& f, double from, double to);

}  // namespace flatspeckle::tests
