#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "wave_solver/skeletons/interpolative.h"

namespace flatspeckle::wave::test_interpolative {

namespace {

// Row-major matrix.
struct Matrix {
  std::size_t rows, columns;
  std::vector<double> values;

  double operator()(std::size_t i, std::size_t j) const { return values[i * columns + j]; }
};

// Returns a random matrix whose singular values decay about as exp(-decay i).
Matrix decaying(std::size_t rows, std::size_t columns, std::size_t rank, double decay) {
  RandomStream random(4, 1, rank);
  Matrix matrix{rows, columns, std::vector<double>(rows * columns)};
  std::vector<double> left(rows), right(columns);
  for (std::size_t term = 0; term < rank; ++term) {
    for (double& value : left) value = random.uniform() - 0.5;
    for (double& value : right) value = random.uniform() - 0.5;
    const double size = std::exp(-decay * static_cast<double>(term));
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < columns; ++j)
        matrix.values[i * columns + j] += size * left[i] * right[j];
  }
  return matrix;
}

Interpolation decomposition(const Matrix& matrix, double tolerance) {
  RowSketch sketch(matrix.columns, RandomStream(1, 2, 3));
  for (std::size_t i = 0; i < matrix.rows; ++i)
    sketch.add(std::span(matrix.values).subspan(i * matrix.columns, matrix.columns));
  return interpolate(std::move(sketch), tolerance);
}

// Returns the largest 2-norm of a column of A(:, redundant) - A(:, skeleton) T.
double largest_error(const Matrix& matrix, const Interpolation& found) {
  double largest = 0;
  for (std::size_t r = 0; r < found.redundant.size(); ++r) {
    double square = 0;
    for (std::size_t i = 0; i < matrix.rows; ++i) {
      double left = matrix(i, found.redundant[r]);
      for (std::size_t s = 0; s < found.skeleton.size(); ++s)
        left -= matrix(i, found.skeleton[s]) * found.t[r + found.redundant.size() * s];
      square += left * left;
    }
    largest = std::max(largest, std::sqrt(square));
  }
  return largest;
}

double largest_coefficient(const Interpolation& found) {
  double largest = 0;
  for (double t : found.t) largest = std::max(largest, std::abs(t));
  return largest;
}

}  // namespace

TEST_CASE("interpolation: a matrix of exactly low rank is represented to rounding") {
  for (const std::size_t rank : {1, 20, 64}) {
    const auto matrix = decaying(300, 150, rank, 0);
    const auto found = decomposition(matrix, 1e-11);
    CHECK(found.skeleton.size() >= rank);
    CHECK(found.skeleton.size() < rank + 8);  // panels are eliminated as a whole
    CHECK(largest_error(matrix, found) < 1e-11);
    CHECK(largest_coefficient(found) < 100);
  }
}

TEST_CASE("interpolation: the error follows the tolerance, the rank its logarithm") {
  const auto matrix = decaying(700, 450, 450, 0.15);
  for (const double tolerance : {1e-2, 1e-5, 1e-8, 1e-11}) {
    const auto found = decomposition(matrix, tolerance);
    const double error = largest_error(matrix, found);
    CHECK(error < 2 * tolerance);
    CHECK(error > 1e-4 * tolerance);  // not needlessly accurate
    // Norms of terms are about sqrt(rows columns) / 12 exp(-0.15 i) = 46.8 exp(-0.15 i).
    const double terms = std::log(46.8 / tolerance) / 0.15;
    CHECK(static_cast<double>(found.skeleton.size()) < terms + 32);
    CHECK(largest_coefficient(found) < 100);
  }
}

TEST_CASE("interpolation: skeleton and redundant columns partition all columns, in order") {
  const auto found = decomposition(decaying(200, 120, 30, 0.1), 1e-6);
  std::vector<std::size_t> all = found.skeleton;
  all.insert(all.end(), found.redundant.begin(), found.redundant.end());
  CHECK(std::is_sorted(found.skeleton.begin(), found.skeleton.end()));
  CHECK(std::is_sorted(found.redundant.begin(), found.redundant.end()));
  std::sort(all.begin(), all.end());
  REQUIRE(all.size() == 120);
  for (std::size_t j = 0; j < all.size(); ++j) CHECK(all[j] == j);
  CHECK(found.t.size() == found.skeleton.size() * found.redundant.size());
}

TEST_CASE("interpolation: empty, zero and full-rank matrices, fewer rows than columns") {
  CHECK(decomposition({5, 0, {}}, 1e-6).skeleton.empty());
  const auto zeros = decomposition({5, 40, std::vector<double>(200)}, 1e-6);
  CHECK(zeros.skeleton.empty());
  CHECK(zeros.redundant.size() == 40);
  CHECK(decomposition(decaying(300, 40, 40, 0), 1e-9).redundant.empty());
  const auto flat = decaying(10, 100, 10, 0);
  const auto found = decomposition(flat, 1e-10);
  CHECK(found.skeleton.size() <= 60);  // samples without rows add useless pivots
  CHECK(largest_error(flat, found) < 1e-11);
}

TEST_CASE("row sketch: real and imaginary parts of a row are two rows") {
  const auto matrix = decaying(200, 60, 25, 0);
  RowSketch sketch(60, RandomStream(1, 2, 4));
  for (std::size_t i = 0; i < 200; i += 2) {
    std::vector<Complex> row;
    for (std::size_t j = 0; j < 60; ++j) row.push_back({matrix(i, j), matrix(i + 1, j)});
    sketch.add(row);
  }
  const auto found = interpolate(std::move(sketch), 1e-10);
  CHECK(found.skeleton.size() >= 25);
  CHECK(largest_error(matrix, found) < 1e-11);
}

}  // namespace flatspeckle::wave::test_interpolative
