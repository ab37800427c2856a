#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "mc/imaging/recovery/camera_noise.h"

namespace flatspeckle::mc {

/// How many sources frames have.
struct SourceCount {
  std::vector<double> singular_values;  ///< of the frames, their noise white, largest first
  double threshold = 0;                 ///< what noise alone does not exceed
  std::size_t sources = 0;              ///< singular values above it
};

/// light: of frames, [pixel][frame], its mean 1, without the background. Where the camera is known,
/// rows and columns are scaled so that the noise of every one has the variance 1 in the mean
/// (biwhitening, Landa, Zhang and Kluger 2022); the largest singular value of such noise is
/// sqrt(pixels) + sqrt(frames), with 99 of 100 below the quantile of Tracy and Widom's distribution
/// (Johnstone 2001). Without photons noise is taken to be white: what exceeds it so far that it
/// helps is known from the median singular value (Gavish and Donoho 2014), where fewer than half as
/// many sources as frames are bright. Not below 1e-6 of the largest, where rounding is.
SourceCount source_count(const Eigen::MatrixXd& light, const CameraNoise& noise);

}  // namespace flatspeckle::mc
