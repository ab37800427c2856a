#include <algorithm>
#include <cmath>

#include "core/run/interrupt.h"
#include "mc/imaging/separation/separation.h"

namespace flatspeckle::mc {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns an initial brightness, [frame][source]. Each source takes the values of one pixel in all
/// frames. This pixel is farthest from all linear combinations of the pixels chosen before. Dim
/// pixels, which noise dominates, are excluded.
MatrixXd purest_pixels(const MatrixXd& frames, Index sources) {
  const VectorXd light = frames.rowwise().sum();
  MatrixXd left = frames;
  for (Index p = 0; p < left.rows(); ++p)
    left.row(p) *= light[p] > light.mean() / 2 ? 1 / light[p] : 0;
  MatrixXd pure(frames.cols(), sources);
  for (Index s = 0; s < sources; ++s) {
    Index pixel = 0;
    left.rowwise().squaredNorm().maxCoeff(&pixel);
    pure.col(s) = frames.row(pixel).cwiseMax(0.0);
    const VectorXd along = left.row(pixel).normalized();
    left -= (left * along) * along.transpose();
  }
  return pure;
}

/// Reduces |frames - factor * other^T|^2 by optimising one column of `factor` after the other.
/// with: frames * other. square: other^T * other.
void improve(MatrixXd& factor, const MatrixXd& with, const MatrixXd& square) {
  constexpr int sweeps = 3;
  constexpr double least = 1e-12;  // a column of zeros would remain zero
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (Index s = 0; s < factor.cols(); ++s) {
      const VectorXd step = with.col(s) - factor * square.col(s);
      factor.col(s) = (factor.col(s) + step / std::max(square(s, s), least)).cwiseMax(least);
    }
}

/// Returns |frames - pattern * brightness^T|^2 from products that are already computed.
double squared_difference(double all, const MatrixXd& brightness, const MatrixXd& with,
                          const MatrixXd& square) {
  const double product = brightness.cwiseProduct(with).sum(),
               own = (brightness.transpose() * brightness).cwiseProduct(square).sum();
  return std::max(all - 2 * product + own, 0.0);
}

/// Returns |t - 1|, where t is the factor by which the product must be multiplied to fit the frames
/// best; at a minimum of the residual t is 1. If an iteration reduces the squared residual r^2 by
/// no more than a fraction `settled`, (t - 1)^2 is below settled r^2. The limit allows for several
/// such iterations.
Invariant scale_error(const MatrixXd& frames, const NonnegativeFactors& found, double settled) {
  constexpr double iterations = 10, rounding = 1e-9;
  const MatrixXd product = found.pattern * found.brightness.transpose();
  const double size = product.squaredNorm();
  if (!(size > 0)) return {};
  return {std::abs(frames.cwiseProduct(product).sum() / size - 1),
          std::sqrt(iterations * settled) * found.residual + rounding};
}

}  // namespace

NonnegativeFactors nonnegative_factors(const MatrixXd& frames, const FactorTask& task) {
  const auto sources = static_cast<Index>(task.sources);
  NonnegativeFactors found;
  found.brightness = purest_pixels(frames, sources);
  found.pattern = MatrixXd::Ones(frames.rows(), sources);
  const double all = frames.squaredNorm();
  double last = all;
  for (int i = 0; i < task.iterations; ++i) {
    stop_if_interrupted();
    improve(found.pattern, frames * found.brightness,
            found.brightness.transpose() * found.brightness);
    const MatrixXd with = frames.transpose() * found.pattern,
                   square = found.pattern.transpose() * found.pattern;
    improve(found.brightness, with, square);
    const double left = squared_difference(all, found.brightness, with, square);
    found.residual = all > 0 ? std::sqrt(left / all) : 0;
    if (last - left <= task.settled * left) break;
    last = left;
  }
  for (Index s = 0; s < sources; ++s) {
    const double mean = found.pattern.col(s).mean();
    found.pattern.col(s) /= mean;
    found.brightness.col(s) *= mean;
  }
  found.scale = scale_error(frames, found, task.settled);
  return found;
}

}  // namespace flatspeckle::mc
