#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "core/numbers/random.h"
#include "reference.h"
#include "wave_solver/dense/dense_factor.h"
#include "wave_solver/equations/t_matrix_system.h"

namespace flatspeckle::wave::test_dense_factor {

namespace {

// Resonant points, ten per square wavelength: the worst conditioning of lossless media.
TMatrixSystem resonant_points(std::size_t count) {
  RandomStream random(7, 1, count);
  const double side = std::sqrt(static_cast<double>(count) / 10);
  Placement placement(count);
  for (auto& placed : placement)
    placed.position = {side * random.uniform(), side * random.uniform()};
  return {placement, two_pi, 1e-12};
}

std::vector<Complex> random_columns(std::size_t size) {
  RandomStream random(8, 1, 0);
  std::vector<Complex> values(size);
  for (Complex& value : values) value = {random.uniform() - 0.5, random.uniform() - 0.5};
  return values;
}

std::vector<Complex> product(const Entries& matrix, const std::vector<Complex>& x, std::size_t n) {
  std::vector<Complex> y(x.size());
  for (std::size_t column = 0; column < x.size() / n; ++column)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i)
        y[column * n + i] += matrix[j * n + i] * x[column * n + j];
  return y;
}

// Returns the residual relative to b; a stable method exceeds rounding by at most the condition
// number.
double residual(const Entries& matrix, const std::vector<Complex>& x, const std::vector<Complex>& b,
                std::size_t n) {
  return relative_distance(product(matrix, x, n), b);
}

}  // namespace

TEST_CASE("factor_symmetric: L L^T equals the matrix, its upper triangle is unchanged") {
  for (const std::size_t n : {1, 31, 32, 33, 200, 500}) {
    const auto system = resonant_points(n);
    const auto matrix = system.matrix();
    auto l = matrix;
    REQUIRE(factor_symmetric(l.data(), n, n));
    double worst = 0, upper = 0;
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = j; i < n; ++i) {
        Complex sum = 0;
        for (std::size_t m = 0; m <= j; ++m) sum += l[m * n + i] * l[m * n + j];
        worst = std::max(worst, std::abs(sum - matrix[j * n + i]));
        if (i > j) upper = std::max(upper, std::abs(l[i * n + j] - matrix[i * n + j]));
      }
    CAPTURE(n);
    CHECK(worst < 1e-12);  // n rounding errors of entries of L of moderate size
    CHECK(upper == 0);
  }
}

TEST_CASE("factor_symmetric: a vanishing pivot is reported") {
  std::vector<Complex> exchange{0, 1, 1, 0};
  CHECK_FALSE(factor_symmetric(exchange.data(), 2, 2));
}

TEST_CASE("dense factor: resonant points have a small residual without row exchanges") {
  const auto system = resonant_points(500);
  const auto b = random_columns(500 * 10);
  DenseFactor factor(system.matrix(), 500);
  CHECK(residual(system.matrix(), factor.solve(b), b, 500) < 1e-12);
  CHECK_FALSE(factor.is_pivoted());
}

TEST_CASE("dense factor: a small nonzero pivot is detected by the residual") {
  auto matrix = resonant_points(400).matrix();
  matrix[0] = 1e-14;
  const auto b = random_columns(400 * 3);
  DenseFactor factor(matrix, 400);
  const auto x = factor.solve(b);
  CHECK(residual(matrix, x, b, 400) < 1e-11);
}

TEST_CASE("dense factor: rows are exchanged if pivots vanish") {
  const Entries matrix{0, 1, 0, 1, 0, 0, 0, 0, 2};
  const std::vector<Complex> b{1, 2, 3};
  DenseFactor factor(matrix, 3);
  const auto x = factor.solve(b, true);
  CHECK(factor.is_pivoted());
  CHECK(relative_distance(x, std::vector<Complex>{2, 1, 1.5}) < 1e-15);
  CHECK(factor.condition() == doctest::Approx(std::sqrt(6 * 2.25)));
}

TEST_CASE(
    "dense factor: the condition number is that of the Frobenius norm within a factor of two") {
  const std::size_t n = 300;
  const auto matrix = resonant_points(n).matrix();
  DenseFactor factor(matrix, n);
  std::vector<Complex> unit(n * n);
  for (std::size_t i = 0; i < n; ++i) unit[i * (n + 1)] = 1;
  double square = 0, inverse_square = 0;
  for (const Complex& value : matrix) square += std::norm(value);
  for (const Complex& value : factor.solve(unit, true)) inverse_square += std::norm(value);
  const double ratio = factor.condition() / std::sqrt(square * inverse_square);
  CHECK(ratio > 0.5);
  CHECK(ratio < 2);
}

TEST_CASE("combinations: a few random sums estimate the size of many columns") {
  const std::size_t n = 500;
  const auto b = random_columns(64 * n);
  CHECK(combinations(b, n).size() < b.size() / 10);
  CHECK(relative_size(combinations(b, n), b, std::vector<double>(n, 1)) ==
        doctest::Approx(1).epsilon(0.1));  // 4 n random numbers: 1 +- 1 / sqrt(8 n) = 0.016
}

TEST_CASE("dense factor: singular and infinite systems are rejected") {
  CHECK_THROWS_AS(DenseFactor({1, 1, 1, 1}, 2).solve({1, 2}), std::runtime_error);
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(DenseFactor({infinity}, 1), std::runtime_error);
}

}  // namespace flatspeckle::wave::test_dense_factor
