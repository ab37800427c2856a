#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <doctest/doctest.h>

#include "bench/cost/cost_measure.h"
#include "bench/error/error_curve.h"
#include "bench/error/error_measure.h"
#include "bench/measure/power_fit.h"
#include "core/numbers/random.h"

namespace flatspeckle::bench::test_error_curve {

namespace {

constexpr std::uint64_t stream = 2001;

/// Returns a method that estimates 16 entries, each the mean of 1 + offset + draw(random). The mean
/// of `draw` is 0, so the reference is 1.
template <class Draw>
ErrorMethod toy(Draw draw, double offset = 0) {
  constexpr std::size_t entries = 16;
  return {"toy", "toy", [=](std::uint64_t seed) {
            ErrorTrial trial{{}, sample_mean};
            trial.batches.size = entries;
            trial.batches.run = [=](std::uint64_t number, std::span<Complex> sums) {
              RandomStream random(seed, stream, number);
              for (Complex& sum : sums) sum += 1 + offset + draw(random);
            };
            return trial;
          }};
}

double uniform(RandomStream& random) {
  return std::sqrt(3.0) * (2 * random.uniform() - 1);  // variance 1
}

/// Samples the density 0.4 / |x|^1.8 for |x| > 1, which has infinite variance. The error of the
/// mean of n samples grows as n^(1/0.8 - 1).
double heavy(RandomStream& random) {
  const double sign = random.uniform() < 0.5 ? -1 : 1;
  return sign * std::pow(random.uniform(), -1 / 0.8);
}

ErrorReference ones(double error = 0) {
  return {std::vector<Complex>(16, 1.0), error, "closed form"};
}

}  // namespace

TEST_CASE("fit_power: exponent and its error agree with closed forms") {
  const std::vector<double> x{1, 2, 4, 8}, y{3, 12, 48, 192};
  const PowerFit exact = fit_power(x, y);
  CHECK(exact.exponent == doctest::Approx(2));
  CHECK(exact.exponent_error < 1e-12);
  const std::vector<double> weight{1, 2, 3, 4};
  CHECK(fit_power(x, y, weight).amplitude == doctest::Approx(3));
  // one point is off by a factor e^d; slope and scatter are known in closed form
  const double d = 0.1;
  const std::vector<double> off{3, 12, 48, 192 * std::exp(d)};
  const PowerFit fitted = fit_power(x, off);
  CHECK(fitted.exponent == doctest::Approx(2 + 0.3 * d / std::numbers::ln2));
  CHECK(fitted.exponent_error ==
        doctest::Approx(std::sqrt((0.75 - 0.45) * d * d / 2 / 5) / std::numbers::ln2));
}

TEST_CASE("measure_error: independent samples have slope -1/2 and the expected efficiency") {
  const ErrorCurve curve = measure_error(toy(uniform), ones(), 0.2);
  CHECK(curve.slope_error > 0);
  CHECK(curve.slope_error < 0.03);
  CHECK(std::abs(curve.slope + 0.5) < 4 * curve.slope_error);
  for (const ErrorPoint& point : curve.points)
    CHECK(point.error == doctest::Approx(1 / std::sqrt(point.samples)).epsilon(0.2));
  const ErrorPoint& last = curve.points.back();
  CHECK(curve.efficiency ==
        doctest::Approx(1 / (last.error * last.error * last.cpu_s)).epsilon(0.4));
}

TEST_CASE(
    "measure_error: a bias flattens the slope, and the error of the reference is subtracted") {
  constexpr double offset = 0.05;
  const ErrorCurve biased = measure_error(toy(uniform, offset), ones(), 0.2);
  CHECK(biased.slope > -0.45);
  CHECK(biased.points.back().error == doctest::Approx(offset).epsilon(0.3));
  const ErrorCurve mended = measure_error(toy(uniform, offset), ones(offset), 0.2);
  CHECK(mended.slope < -0.47);
  CHECK(mended.slope_error > biased.slope_error);  // includes the error of the reference
}

TEST_CASE("measure_error: infinite variance changes the slope or its error") {
  const ErrorCurve curve = measure_error(toy(heavy), ones(), 0.2);
  // the result depends on when the largest sample occurs: either the slope is too shallow or its
  // error is large
  CHECK(std::max(curve.slope + 0.5, curve.slope_error) > 0.1);
}

TEST_CASE("measure_cost: a nested loop has exponent 2") {
  const Scaling scaling{"loops", "n", 64, 1024, 2, [](double size) {
                          return [n = static_cast<int>(size), sum = std::make_shared<double>()] {
                            for (int i = 0; i < n; ++i)
                              for (int j = 0; j < n; ++j) *sum = *sum * 0.999 + i + j;
                          };
                        }};
  const CostCurve curve = measure_cost(scaling, 0.1);
  CHECK(curve.size.size() == 5);
  CHECK(curve.exponent == doctest::Approx(2).epsilon(0.1));
}

}  // namespace flatspeckle::bench::test_error_curve
