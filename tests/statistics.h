#pragma once

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <vector>

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

  ChiSquare(const std::vector<double>& counts, const std::vector<double>& probabilities);

  double limit() const;
};

/// The probabilities must be those of all that was counted.
void check_chi_square(const std::vector<double>& counts, const std::vector<double>& probabilities);

/// The seed of this number; where FLATSPECKLE_TEST_SEED is set (scripts/check.sh), a fresh one.
std::uint64_t fresh_seed(std::uint64_t number);

/// Whether tests take all of their samples and cases (FLATSPECKLE_TEST_WHOLE is set), as by night.
inline const bool is_night = std::getenv("FLATSPECKLE_TEST_WHOLE") != nullptr;

/// Long tests take this part of their samples, a quarter by day, and their errors may be so much larger.
struct Effort {
  double samples = 0.25, errors = 2;
};
Effort effort();

/// Integral by adaptive Gauss-Kronrod quadrature, to a relative 1e-10 or so.
double integral(const std::function<double(double)>& f, double from, double to);

}  // namespace flatspeckle::tests
