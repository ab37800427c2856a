#include <cmath>
#include <random>
#include <vector>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "core/search/levenberg_marquardt.h"
#include "mc/fit/task/fit_data.h"
#include "mc/fit/task/measurement.h"

namespace flatspeckle::mc::test_correlated_errors {

TEST_CASE("correlated errors: covariance of ratios of sums agrees with linear error propagation") {
  // x and y: means 10 and 20, variances 1 and 4, correlation 1/2; values are x / 10 and y / x.
  constexpr int batches = 4000;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  GroupedSums sums(2);
  for (int batch = 0; batch < batches; ++batch) {
    const double a = normal(random), b = normal(random);
    const Complex values[] = {10 + a, 20 + 2 * (0.5 * a + std::sqrt(0.75) * b)};
    sums.add(1, values);
  }
  const Estimator theta = [](double samples, std::span<const Complex> total) {
    return std::vector<Complex>{total[0] / samples / 10.0, total[1] / total[0]};
  };
  const Eigen::MatrixXd found = correlated_errors(sums, theta);
  REQUIRE(found.rows() == 2);
  // d(y/x) = dy/10 - dx/5: variance 4/100 + 1/25 - 2 (1)/50, covariance with x/10: (1/10 - 1/5)/10
  const double n = batches;
  CHECK(found(0, 0) * n == doctest::Approx(0.01).epsilon(0.3));
  CHECK(found(1, 1) * n == doctest::Approx(0.04).epsilon(0.3));
  CHECK(found(0, 1) * n == doctest::Approx(-0.01).epsilon(0.3));
  CHECK(found(0, 1) == found(1, 0));
}

TEST_CASE("correlated errors: the inverse covariance from few groups is unbiased") {
  // A fit weights by the inverse covariance. For the mean of 12 numbers of variance 1 it is 12.
  constexpr int groups = 12, runs = 20000;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double sum = 0, squares = 0;
  for (int run = 0; run < runs; ++run) {
    GroupedSums sums(1);
    for (int group = 0; group < groups; ++group) sums.add(1, std::vector<Complex>{normal(random)});
    const double inverse = 1 / correlated_errors(sums, sample_mean)(0, 0);
    sum += inverse / runs;
    squares += inverse * inverse / runs;
  }
  CHECK(std::abs(sum - groups) < 4 * std::sqrt((squares - sum * sum) / runs));
}

TEST_CASE("correlated errors: shrinkage limits the cancellation of errors in a difference") {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  GroupedSums sums(2);
  for (int batch = 0; batch < 512; ++batch) {
    const double a = normal(random);
    const Complex values[] = {10 + a, 10 + a + 1e-6 * normal(random)};
    sums.add(1, values);
  }
  const Eigen::MatrixXd found = correlated_errors(sums, sample_mean);
  const Eigen::Vector2d difference(1, -1);
  const double groups = static_cast<double>(sums.groups());
  CHECK(difference.dot(found * difference) ==
        doctest::Approx((found(0, 0) + found(1, 1)) / groups).epsilon(0.01));
}

TEST_CASE("correlated errors: mean chi^2 agrees with the expected degrees of freedom") {
  // Six points of a line whose errors are a smooth curve and a little noise. After shrinkage most
  // of their combinations have little weight. Independent errors have 4 degrees of freedom.
  constexpr int runs = 400, batches = 256, points = 6;
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd basis(points, 2);
  for (int i = 0; i < points; ++i) basis.row(i) << 1, i;
  for (const double noise : {1e-4, 0.03, 10.0}) {
    double sum = 0, squares = 0, degrees = 0;
    for (int run = 0; run < runs; ++run) {
      GroupedSums sums(points);
      for (int batch = 0; batch < batches; ++batch) {
        const double a = normal(random), b = normal(random), c = normal(random);
        std::vector<Complex> values;
        for (int i = 0; i < points; ++i)
          values.emplace_back(a + 0.3 * b * i + 0.05 * c * i * i + noise * normal(random));
        sums.add(1, values);
      }
      FitTask task;
      task.measurements.resize(1);
      Measurement& one = task.measurements.front();
      const auto mean = real_parts(sample_mean(sums.total_samples(), sums.total()));
      one.values = Eigen::Map<const Eigen::VectorXd>(mean.data(), points);
      one.covariance = correlated_errors(sums, sample_mean);
      one.shrinkage = shrinkage_of(sums);
      const FitData data(task);
      const Eigen::MatrixXd derivatives = data.whitened(basis);
      const Eigen::VectorXd white = data.whitened(one.values);
      const Eigen::VectorXd best =
          (derivatives.transpose() * derivatives).inverse() * derivatives.transpose() * white;
      const double chi_squared = (white - derivatives * best).squaredNorm();
      sum += chi_squared / runs;
      squares += chi_squared * chi_squared / runs;
      degrees += expected_chi_squared(data.whitened(data.whitened(data.scatter()).transpose()),
                                      derivatives) /
                 runs;
    }
    CAPTURE(noise);
    CHECK(std::abs(sum - degrees) < 4 * std::sqrt((squares - sum * sum) / runs));
    CHECK(degrees < (noise < 1e-3 ? 1.5 : 4.1));
  }
}

TEST_CASE("correlated errors: too few groups give no covariance") {
  GroupedSums sums(2);
  const Complex values[] = {1, 2};
  for (int batch = 0; batch < 5; ++batch) sums.add(1, values);
  CHECK(correlated_errors(sums, sample_mean).size() == 0);
}

}  // namespace flatspeckle::mc::test_correlated_errors
