#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

namespace flatspeckle::mc {

/// Intensity correlation C_I of the first channel with each other channel, and the covariance of
/// the errors of these values.
struct PairCorrelations {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
};

/// Estimates C_I of each channel with the first one, from intensities of circular Gaussian fields
/// in independent patterns, [pattern][channel]. Each channel forms a pair with the first one, and
/// C_I is the value C that maximises the likelihood of their intensities x and y, in units of the
/// means:
///   p(x, y) = exp(-(x + y)/(1 - C)) I_0(2 sqrt(C x y)/(1 - C)) / (1 - C)
/// (Goodman, Speckle Phenomena in Optics, eq. 4-33). The likelihood of all channels together has no
/// closed form; estimates from pairs are unbiased. For C_I below 0.1 the mean of x y - 1 is used
/// instead, which is as accurate there; at C_I = 0.95 its error would be 23 times as large. The
/// covariance of the errors follows from the spread of the scores over the patterns (Godambe). It
/// includes the errors of the mean intensities. Requires more patterns than channels plus two.
PairCorrelations likeliest_correlations(std::span<const double> intensities, std::size_t channels);

}  // namespace flatspeckle::mc
