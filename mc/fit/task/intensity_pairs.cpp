#include "mc/fit/task/intensity_pairs.h"

#include <cmath>

namespace flatspeckle::mc {

namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;

/// Returns I_1(z) / I_0(z).
double bessel_ratio(double z) {
  constexpr double far = 30;
  if (z < far) return std::cyl_bessel_i(1, z) / std::cyl_bessel_i(0, z);
  const double t = 1 / z;
  return 1 - t * (0.5 + t * (0.125 + t * (0.125 + t * 25 / 128)));
}

/// Score of C_I = c for intensities x and y of two channels: the derivative of the log likelihood
/// by c, or x y - 1 - c. Its expectation is 0 if c is the true value of C_I.
class Score {
 public:
  explicit Score(bool likelihood) : likelihood_(likelihood) {}

  double operator()(double x, double y, double c) const {
    if (!likelihood_) return x * y - 1 - c;
    const double rest = 1 - c, root = std::sqrt(x * y / c);
    return (1 - (x + y) / rest + bessel_ratio(2 * c * root / rest) * root * (1 + c) / rest) / rest;
  }
  ArrayXd operator()(const ArrayXd& x, const ArrayXd& y, double c) const {
    return x.binaryExpr(y, [&](double a, double b) { return (*this)(a, b, c); });
  }

 private:
  bool likelihood_;
};

/// Returns the c at which the score, averaged over the patterns, is 0.
double root_of(const Score& score, const ArrayXd& x, const ArrayXd& y) {
  constexpr double least = 1e-6, precise = 1e-12;
  double low = least, high = 1 - least;
  while (high - low > precise * high) {
    const double middle = (low + high) / 2;
    (score(x, y, middle).mean() > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Estimate of C_I of two channels, and the influence of each pattern on this estimate.
struct PairEstimate {
  double value = 0;
  ArrayXd influence;

  PairEstimate(const ArrayXd& x, const ArrayXd& y) {
    constexpr double small = 0.1, step = 1e-4;
    value = (x * y).mean() - 1;
    const Score score(value > small);
    if (value > small) value = root_of(score, x, y);
    const auto mean = [&](double x_scale, double y_scale, double c) {
      return score(x * x_scale, y * y_scale, c).mean();
    };
    const double change = step * (1 - value),
                 derivative =
                     (mean(1, 1, value - change) - mean(1, 1, value + change)) / (2 * change),
                 by_x = (mean(1 - step, 1, value) - mean(1 + step, 1, value)) / (2 * step),
                 by_y = (mean(1, 1 - step, value) - mean(1, 1 + step, value)) / (2 * step);
    influence = (score(x, y, value) + by_x * (x - 1) + by_y * (y - 1)) / derivative;
  }
};

}  // namespace

PairCorrelations likeliest_correlations(std::span<const double> intensities, std::size_t channels) {
  const auto columns = static_cast<Index>(channels), pairs = columns - 1;
  const Index patterns = std::ssize(intensities) / columns;
  MatrixXd x = Eigen::Map<const MatrixXd>(intensities.data(), columns, patterns).transpose();
  for (Index i = 0; i < columns; ++i) x.col(i) /= x.col(i).mean();
  PairCorrelations found;
  found.values.resize(pairs);
  MatrixXd influence(patterns, pairs);
  for (Index i = 0; i < pairs; ++i) {
    const PairEstimate pair(x.col(0), x.col(i + 1));
    found.values[i] = pair.value;
    influence.col(i) = pair.influence;
  }
  const auto n = static_cast<double>(patterns);
  // The factor n - pairs - 2 makes the inverse of the covariance unbiased (Hartlap, Simon and
  // Schneider [hartlap2007], eq. 17).
  found.covariance = influence.transpose() * influence / (n * (n - static_cast<double>(pairs) - 2));
  return found;
}

}  // namespace flatspeckle::mc
