#pragma once

#include <cstddef>
#include <vector>

#include "core/frames/frames.h"
#include "core/result/invariant.h"

namespace flatspeckle::mc {

/// Settings of maps of the squared speckle contrast K^2 = variance / mean^2 of frames.
struct ContrastTask {
  enum class Over { space, time };
  Over over = Over::space;  ///< whether the variance is that of neighbouring pixels or of frames
  std::size_t window = 7;   ///< side, in pixels, of the square about each pixel
  double per_photon = 0;    ///< counts per photon; 0: shot noise is not subtracted
  double read_noise = 0;    ///< standard deviation of the camera's read noise, in counts
};

/// K^2 of the light in a window about each pixel, without the camera's noise. Pixels nearer to the
/// edge than half a window are left out.
struct ContrastMap {
  std::size_t rows = 0, columns = 0;
  std::vector<double> square, error;  ///< K^2 and its standard error, [y][x]
  std::vector<double> mean;           ///< mean of the counts
  double correlation = 0;  ///< mean correlation of two pixels of a window: 1/N for N grains
  /// Check: relative difference between the variance of all pixels and the sum of the variances
  /// within and between separate windows.
  Invariant variance;
};

/// Computes the map of K^2 from frames of one scene. The variance within a window is too small,
/// because its mean is estimated from the same pixels; it is divided by 1 - c, where c is the mean
/// correlation of two pixels of the window, measured from the autocorrelation of the frames. Over
/// time, frames must be independent of each other. The error is that of Gaussian fluctuations with
/// the kurtosis of a gamma distribution of the intensity, for the measured correlation
/// [goodman2007].
ContrastMap contrast_map(const Frames& frames, const ContrastTask& task);

/// Returns the decay rate 1/tau of a correlation |g1| = exp(-t / tau), times the exposure, at which
/// the squared contrast is `square` [bandyopadhyay2005]: K^2 = beta (exp(-2 x) - 1 + 2 x) / (2 x^2)
/// for x = exposure / tau. 0 if the contrast is at least beta, and infinite if it is not positive.
double decays_per_exposure(double square, double beta);

}  // namespace flatspeckle::mc
