#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

namespace flatspeckle::mc {

/// C_I of intensities with the first, and the covariance of its errors.
struct PairCorrelations {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
};

/// Of intensities of circular Gaussian fields in independent patterns, [pattern][channel], each in
/// units of its mean: the C_I that makes each channel and the first likeliest as a pair,
///   p(x, y) = exp(-(x + y)/(1 - C)) I_0(2 sqrt(C x y)/(1 - C)) / (1 - C)
/// (Goodman, Speckle Phenomena in Optics, eq. 4-33). All channels at once have no closed form; the
/// likelihood of pairs is unbiased. From the mean of x y - 1, which is as good where C_I is small
/// and is taken below 0.1, C_I of 0.95 has an error 20 times as large. Errors, and how those of
/// pairs and means are correlated, are by the spread of the scores (Godambe). More patterns than
/// channels and two.
PairCorrelations likeliest_correlations(std::span<const double> intensities, std::size_t channels);

}  // namespace flatspeckle::mc
