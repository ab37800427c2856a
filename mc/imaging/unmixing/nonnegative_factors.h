#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace flatspeckle::mc {

/// Frames of sources that are bright in some and dark in others: frames = pattern * brightness^T,
/// both not negative.
struct NonnegativeFactors {
  Eigen::MatrixXd pattern;     ///< [pixel][source], the mean over the pixels 1
  Eigen::MatrixXd brightness;  ///< [frame][source]
  double residual = 0;  ///< rms of what the frames differ by from the product, over their rms
};

/// How the factors are improved.
struct FactorTask {
  std::size_t sources = 1;
  int iterations = 3000;  ///< at most
  double settled = 1e-5;  ///< stops where an iteration lowers the residual by less than this part
};

/// frames: [pixel][frame]. Hierarchical alternating least squares (Cichocki and Phan 2009), several
/// sweeps over each factor while the other stands (Gillis and Glineur 2012). They begin with the
/// pixels in which a single source prevails, by successive projection (Araujo et al. 2001): speckle
/// has dark places everywhere, so that each source has pixels nearly of its own, and factors are
/// unique but for their order.
NonnegativeFactors nonnegative_factors(const Eigen::MatrixXd& frames, const FactorTask& task);

}  // namespace flatspeckle::mc
