#pragma once

#include <span>
#include <vector>

namespace flatspeckle::mc {

/// What a frame tells of pairs of points, by their distance: the autocorrelation, filtered so that
/// noise of the camera, which knows nothing of grains, is suppressed.
struct PairPeaks {
  double step = 1;             ///< pixels from one lag to the next: a third of a grain
  std::vector<double> height;  ///< of the peak of a pair at each lag; the mean square of its noise
                               ///< is noise^2
  double noise = 0;
  double alone = 0;  ///< the autocorrelation at lag 0, (sum of b^2) / (sum of b)^2
  double width = 1;  ///< pixels of a filtered peak, as a grain's: a third more at most
};

/// What is known of an estimated autocorrelation.
struct AutocorrelationTerms {
  double alone = 0, white = 0;  ///< at lag 0, of the light and of the camera
  double band = 1;              ///< of the speckle, cycles per pixel
};

/// A frame of power P = alone T + white, T that of speckle of unit variance, has an autocorrelation
/// whose noise has the spectrum P^2 / pixels (Bartlett's formula); the peak of a pair has T. Of
/// filters T / P^n, n = 2 is the best in Gaussian noise, but rings where the camera has none and a
/// pair stands beside another; n = 1, which is taken here, passes an autocorrelation without noise
/// of the camera as it is. The peak about lag 0 is taken off. autocorrelation: by lag in pixels,
/// the camera's noise taken off lag 0; of as many lags beyond the first `lags` nothing is expected
/// but noise.
PairPeaks pair_peaks(std::span<const double> autocorrelation, std::size_t lags,
                     const AutocorrelationTerms& terms);

}  // namespace flatspeckle::mc
