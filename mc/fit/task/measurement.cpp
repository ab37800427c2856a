#include "mc/fit/task/measurement.h"

#include <array>
#include <cmath>

#include <Eigen/LU>

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A packed number is tr(E S) of a Hermitian matrix E of at most two entries.
struct PatternReading {
  struct Term {
    Index row, column;
    Complex factor;
  };
  std::vector<Term> terms;
};

std::vector<PatternReading> readings(Index channels) {
  std::vector<PatternReading> all;
  const Complex half = 0.5, turned(0, 0.5);
  for (Index i = 0; i < channels; ++i) {
    for (Index j = 0; j < i; ++j) {
      all.push_back({{{j, i, half}, {i, j, half}}});
      all.push_back({{{j, i, -turned}, {i, j, turned}}});
    }
    all.push_back({{{i, i, 1}}});
  }
  return all;
}

}  // namespace

std::vector<double> packed(std::span<const Complex> lower_triangle) {
  std::vector<double> values;
  std::size_t row = 0, column = 0;
  for (const Complex entry : lower_triangle) {
    values.push_back(entry.real());
    if (column < row) values.push_back(entry.imag());
    if (++column <= row) continue;
    ++row;
    column = 0;
  }
  return values;
}

VectorXd packed(const MatrixXcd& matrix) {
  std::vector<Complex> triangle;
  for (Index i = 0; i < matrix.rows(); ++i)
    for (Index j = 0; j <= i; ++j) triangle.push_back(matrix(i, j));
  const auto values = packed(std::span<const Complex>(triangle));
  return Eigen::Map<const VectorXd>(values.data(), std::ssize(values));
}

MatrixXcd unpacked(const VectorXd& values, std::size_t channels) {
  const auto size = static_cast<Index>(channels);
  MatrixXcd matrix(size, size);
  Index next = 0;
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < i; ++j, next += 2) {
      matrix(i, j) = {values[next], values[next + 1]};
      matrix(j, i) = std::conj(matrix(i, j));
    }
    matrix(i, i) = values[next++];
  }
  return matrix;
}

// Cov(tr(E S), tr(F S)) = tr(E C F C) / N.
MatrixXd sample_errors(const FieldSample& sample, const MatrixXcd& c) {
  const auto all = readings(c.rows());
  const Index size = std::ssize(all);
  MatrixXd errors(size, size);
  for (Index p = 0; p < size; ++p)
    for (Index q = 0; q <= p; ++q) {
      Complex sum = 0;
      for (const auto& e : all[static_cast<std::size_t>(p)].terms)
        for (const auto& f : all[static_cast<std::size_t>(q)].terms)
          sum += e.factor * f.factor * c(e.column, f.row) * c(f.column, e.row);
      errors(p, q) = errors(q, p) = sum.real() / sample.patterns;
    }
  if (sample.known_scale) return errors;
  constexpr double free = 1e6;  // relative to what N patterns tell of the scale
  const VectorXd along = packed(c);
  return errors + free / sample.patterns * along * along.transpose();
}

double likeliest_scale(const MatrixXcd& c, const MatrixXcd& s) {
  return c.partialPivLu().solve(s).trace().real() / static_cast<double>(c.rows());
}

MatrixXcd sample_covariance(std::span<const Complex> fields, std::size_t channels) {
  const auto size = static_cast<Index>(channels),
             patterns = static_cast<Index>(fields.size() / channels);
  const Eigen::Map<const MatrixXcd> columns(fields.data(), size, patterns);
  return columns * columns.adjoint() / static_cast<double>(patterns);
}

}  // namespace flatspeckle::mc
