#include "mc/fit/task/measurement.h"

#include <array>
#include <cmath>

#include <Eigen/LU>

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd real_values(const std::vector<Complex>& values) {
  const auto parts = real_parts(values);
  return Eigen::Map<const VectorXd>(parts.data(), std::ssize(parts));
}

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One of the numbers of packed(S), written as tr(E S) with a Hermitian matrix E. `terms` contains
/// the one or two nonzero entries of E.
struct PatternMeasurement {
  struct Term {
    Index row, column;
    Complex factor;
  };
  std::vector<Term> terms;
};

std::vector<PatternMeasurement> packed_measurements(Index channels) {
  std::vector<PatternMeasurement> all;
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

MatrixXd deviations(const GroupedSums& sums, const Estimator& theta) {
  const double samples = sums.total_samples();
  const auto total = sums.total();
  const VectorXd all = real_values(theta(samples, total));
  const auto groups = static_cast<Index>(sums.groups());
  // Pseudo-values and weights are the same as in jackknife().
  VectorXd mean = VectorXd::Zero(all.size()), rest(groups);
  MatrixXd found(all.size(), groups);
  auto without = total;
  for (std::size_t group = 0; group < sums.groups(); ++group) {
    const auto g = static_cast<Index>(group);
    const auto left_out = sums.group_sums(group);
    for (std::size_t i = 0; i < total.size(); ++i) without[i] = total[i] - left_out[i];
    rest[g] = samples / sums.group_samples(group) - 1;
    found.col(g) = all - real_values(theta(samples - sums.group_samples(group), without));
    mean += rest[g] / (rest[g] + 1) * found.col(g);
  }
  for (Index g = 0; g < groups; ++g)
    found.col(g) = std::sqrt(rest[g]) * found.col(g) - mean / std::sqrt(rest[g]);
  return found / std::sqrt(static_cast<double>(groups));
}

MatrixXd correlated_errors(const GroupedSums& sums, const Estimator& theta) {
  const auto size = static_cast<Index>(theta(sums.total_samples(), sums.total()).size()),
             groups = static_cast<Index>(sums.groups());
  constexpr Index more = 10;
  if (groups < size + more) return {};
  const MatrixXd found = deviations(sums, theta);
  const double of_inverse =
      static_cast<double>(groups - 1) / static_cast<double>(groups - size - 2);
  MatrixXd covariance = of_inverse * found * found.transpose();
  const double shrinkage = shrinkage_of(sums);
  const VectorXd variance = covariance.diagonal();
  covariance *= 1 - shrinkage;
  covariance.diagonal() += shrinkage * variance;
  return covariance;
}

double shrinkage_of(const GroupedSums& sums) {
  return 1 / static_cast<double>(sums.groups());
}

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

// Uses Cov(tr(E S), tr(F S)) = tr(E C F C) / N, for the sample covariance S of N patterns.
MatrixXd sample_errors(const FieldSample& sample, const MatrixXcd& c) {
  const auto all = packed_measurements(c.rows());
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
  // Variance of the scale, relative to the one that N patterns would give.
  constexpr double free = 1e6;
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
