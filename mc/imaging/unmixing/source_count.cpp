#include "mc/imaging/unmixing/source_count.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace flatspeckle::mc {

namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;

/// Of each value.
MatrixXd noise_variances(const MatrixXd& light, const CameraNoise& noise) {
  const double reading = noise.read_noise / noise.photons;
  return ((light.array() + noise.background).max(0.0) / noise.photons + reading * reading).matrix();
}

/// Frames whose rows and columns have noise of the variance 1 in the mean.
MatrixXd whitened(const MatrixXd& light, const CameraNoise& noise) {
  constexpr int rounds = 20;
  constexpr double least = 1e-300;
  const MatrixXd variances = noise_variances(light, noise);
  const auto rows = static_cast<double>(light.rows()), columns = static_cast<double>(light.cols());
  ArrayXd of_row = ArrayXd::Ones(light.rows()), of_column = ArrayXd::Ones(light.cols());
  for (int round = 0; round < rounds; ++round) {
    of_row = columns / (variances * of_column.matrix()).array().max(least);
    of_column = rows / (variances.transpose() * of_row.matrix()).array().max(least);
  }
  return of_row.sqrt().matrix().asDiagonal() * light * of_column.sqrt().matrix().asDiagonal();
}

/// That 99 of 100 matrices of white noise do not exceed.
double largest_of_noise(double rows, double columns) {
  constexpr double quantile = 2.02;  // of Tracy and Widom's distribution for real matrices
  const double a = std::sqrt(rows - 0.5), b = std::sqrt(columns - 0.5),
               scale = (a + b) * std::cbrt(1 / a + 1 / b);
  return std::sqrt((a + b) * (a + b) + quantile * scale);
}

/// most: singular values that are not 0 because the matrix is so small.
double from_median(const std::vector<double>& values, std::size_t most, double aspect) {
  const double by = 0.56 * std::pow(aspect, 3) - 0.95 * aspect * aspect + 1.82 * aspect + 1.43;
  return by * values[most / 2];
}

/// Largest first, from the products of columns.
std::vector<double> singular_values(const MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(matrix.transpose() * matrix,
                                                       Eigen::EigenvaluesOnly);
  std::vector<double> values;
  for (Eigen::Index i = solver.eigenvalues().size(); i-- > 0;)
    values.push_back(std::sqrt(std::max(solver.eigenvalues()[i], 0.0)));
  return values;
}

}  // namespace

SourceCount source_count(const MatrixXd& light, const CameraNoise& noise) {
  constexpr double rounding = 1e-6;
  const auto rows = static_cast<double>(light.rows()), columns = static_cast<double>(light.cols());
  const bool known = noise.photons > 0;
  SourceCount count;
  count.singular_values = singular_values(known ? whitened(light, noise) : light);
  const double fewer = std::min(rows, columns), more = std::max(rows, columns);
  count.threshold =
      known ? largest_of_noise(rows, columns)
            : from_median(count.singular_values, static_cast<std::size_t>(fewer), fewer / more);
  count.threshold = std::max(count.threshold, rounding * count.singular_values.front());
  for (const double value : count.singular_values) count.sources += value > count.threshold;
  return count;
}

}  // namespace flatspeckle::mc
