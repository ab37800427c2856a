#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/frames/frames.h"
#include "core/result/invariant.h"
#include "mc/theory/detector_noise.h"

namespace flatspeckle::mc {

/// Statistics of the pixels of frames of one object. Within the memory effect the autocorrelation
/// of a frame is that of the object times that of a speckle grain [katz2014].
struct PictureStatistics {
  /// Standard deviation divided by the mean, for the frame divided by its envelope; without the
  /// camera's noise.
  double contrast = 0;
  /// Full width at half maximum of the autocorrelation about lag 0, in pixels: sqrt(4 / pi) times
  /// the root of the area in which it exceeds half of its value at lag 0.
  double grain = 0;
  double white = 0;  ///< camera noise: variance divided by the squared mean
  double noise = 0;  ///< standard deviation of the autocorrelation at lags without signal
  /// Autocorrelation at lags from -(lags - 1) to lags - 1 in both directions, [y][x], minus its
  /// mean beyond these lags. The camera's noise is subtracted at lag 0.
  std::vector<double> autocorrelation;
  /// Check: relative difference between the autocorrelation at lag 0, before anything is
  /// subtracted, and the variance of the pixels.
  Invariant variance;
};

/// Returns the width, in pixels, of the Gaussian average that picture_statistics() takes as the
/// envelope of a frame. pixels: rows or columns of the frame, whichever are fewer.
double picture_envelope_width(std::size_t pixels, std::size_t lags);

/// Returns a picture divided by its envelope, minus 1. width: that of the Gaussian average. Throws
/// InputError if the envelope is not positive.
std::vector<double> picture_without_envelope(std::span<const double> picture, std::size_t rows,
                                             std::size_t columns, double width);

/// Computes the statistics of frames of one object; their autocorrelations are averaged. lags:
/// longest extent of the object in pixels; twice the lags must be less than rows and columns. If
/// the number of photons is not known (noise.photons = 0), the camera's noise is the excess of the
/// autocorrelation at lag 0 over its extrapolation from lags 1 and 2, provided that grains are
/// resolved.
PictureStatistics picture_statistics(const Frames& frames, std::size_t first, std::size_t count,
                                     std::size_t lags, const CameraNoise& noise);

}  // namespace flatspeckle::mc
