#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mc/imaging/recovery/camera_noise.h"
#include "mc/imaging/recovery/line_object.h"
#include "mc/imaging/unmixing/nonnegative_factors.h"
#include "mc/imaging/unmixing/source_places.h"

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

/// What is looked for in frames of one medium whose sources blink.
struct UnmixingTask {
  CameraNoise noise = {};        ///< of each frame
  std::size_t lags = 0;          ///< pixels: longer shifts of two patterns are not looked for
  std::size_t sources = 0;       ///< 0: as many as the singular values tell
  double resolution_grains = 1;  ///< shifts agree within so many
};

/// Sources from frames.
struct Unmixed {
  SourceCount count;
  NonnegativeFactors factors;
  SourcePlaces places;
  double grain = 0;  ///< of the patterns, pixels

  /// Of the largest group, in pixels; brightness: mean over the frames, the mean over the
  /// sources 1.
  LineObject object() const;
};

/// Frames of the same pixels. The factorisation (Zhu et al. 2022: fluctuating sources, patterns by
/// non-negative factors, places by their correlations) is of the light alone, in units of its mean.
/// Throws InputError for frames without light, as without_envelope(), and for fewer frames than
/// sources.
Unmixed unmixed(std::span<const std::vector<double>> frames, const UnmixingTask& task);

}  // namespace flatspeckle::mc
