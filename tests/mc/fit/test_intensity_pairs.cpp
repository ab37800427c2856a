#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <doctest/doctest.h>

#include "core/numbers/complex.h"
#include "mc/fit/task/intensity_pairs.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_intensity_pairs {

namespace {

using Eigen::VectorXd;

/// Draws intensities of fields with these correlations C_E to the first field; given the first,
/// the fields are independent.
std::vector<double> drawn(const std::vector<double>& field_correlations, int patterns,
                          std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, std::sqrt(0.5));
  const auto gaussian = [&] {
    const double real = normal(random);
    return Complex(real, normal(random));
  };
  std::vector<double> intensities;
  for (int p = 0; p < patterns; ++p) {
    const Complex first = gaussian();
    intensities.push_back(7 * std::norm(first));
    for (const double c : field_correlations)
      intensities.push_back(3 * std::norm(c * first + std::sqrt(1 - c * c) * gaussian()));
  }
  return intensities;
}

}  // namespace

TEST_CASE(
    "C_I of intensity pairs: unbiased, errors agree with the scatter and are below moments'") {
  const VectorXd truth{{0.98, 0.9, 0.5, 0.03}};
  constexpr int runs = 100;
  const int patterns = tests::is_night ? 1000 : 300;
  std::mt19937_64 random(11);
  VectorXd sum = VectorXd::Zero(truth.size()), squares = sum, errors = sum;
  double chi_squared = 0;
  for (int run = 0; run < runs; ++run) {
    std::vector<double> c;
    for (const double value : truth) c.push_back(std::sqrt(value));
    const auto found = likeliest_correlations(drawn(c, patterns, random), c.size() + 1);
    const VectorXd off = found.values - truth, error = found.covariance.diagonal().cwiseSqrt(),
                   normalised = off.cwiseQuotient(error);
    sum += normalised;
    squares += normalised.cwiseAbs2();
    errors += error / runs;
    chi_squared += off.dot(found.covariance.ldlt().solve(off)) / runs;
  }
  for (int i = 0; i < truth.size(); ++i) {
    CAPTURE(truth[i]);
    CHECK(std::abs(sum[i] / runs) < 4 / std::sqrt(runs));
    CHECK(std::abs(squares[i] / runs - 1) < 4 * std::sqrt(2.0 / runs));
  }
  CHECK(std::abs(chi_squared - 4) < 4 * std::sqrt(8.0 / runs));
  CHECK(errors[0] < 0.05 / std::sqrt(patterns));  // by moments 2 / sqrt(patterns)
  CHECK(errors[3] == doctest::Approx(1.1 / std::sqrt(patterns)).epsilon(0.2));
}

}  // namespace flatspeckle::mc::test_intensity_pairs
