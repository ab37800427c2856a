#pragma once

#include <span>
#include <vector>

namespace flatspeckle::mc {

/// Speckle of light from an even band of directions: its autocorrelation is sinc^2(band lag), whose
/// power spectrum is a triangle that ends at `band` cycles per pixel.

/// Autocorrelation of unit variance at a lag in pixels.
double speckle_peak(double lag, double band);
/// Power of unit variance at a frequency in cycles per pixel, folded where pixels are too coarse.
double speckle_power(double frequency, double band);
/// Pixels of a grain: sum over all lags of the square of the autocorrelation, by which averages
/// over a frame get better; 2 / (3 band) where grains are larger than pixels.
double grain_of(double band);

/// The band whose peak about lag 0 has most of an autocorrelation in it, and at least half of its
/// height; 0 where nothing has. Speckle of few paths has a wide base besides. noise: standard
/// deviation at any lag but 0; there the variance is larger by 2 + white, where white is the
/// variance of the camera's photons over the square of their mean (Poisson's distribution).
double fitted_band(std::span<const double> autocorrelation, double noise, double white = 0);

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
