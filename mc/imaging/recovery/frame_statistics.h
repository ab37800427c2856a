#pragma once

#include <span>
#include <vector>

#include "core/result/invariant.h"
#include "mc/imaging/recovery/camera_noise.h"

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

/// What the pixels of a frame tell without a reference.
struct FrameStatistics {
  double contrast = 0;  ///< standard deviation over mean, of what is left of the envelope
  double square = 0;  ///< of it, below 0 where the camera's noise happened to be less than expected
  double grain = 0;   ///< pixels, as grain_of()
  double grains = 0;  ///< in the frames
  double noise = 0;   ///< standard deviation of the autocorrelation where nothing is expected
  std::vector<double> autocorrelation;  ///< by lag in pixels, from 0
  PairPeaks peaks;
  /// Relative difference between the autocorrelation at lag 0 and the variance of the pixels.
  Invariant variance;
};

/// The frame over its smooth envelope, less 1: what varies within `width` pixels (standard
/// deviation of a Gaussian average). Throws InputError for a frame whose envelope is not positive.
std::vector<double> without_envelope(std::span<const double> frame, double width);

/// Of the envelope of frames whose autocorrelation is looked at: twice the lags, but at most a 32nd
/// of the frame. A wider one leaves what varies slowly as a pedestal under all peaks, higher at
/// short lags, by which a search prefers short objects.
double envelope_width(std::size_t pixels, std::size_t lags);

/// Variance over the square of the mean of what is left of the envelope, in the inner three
/// quarters of at least 64 pixels, less that of the camera, whose shot noise is what the envelope
/// lets expect: the less the brighter. An envelope that is taken from the speckle itself follows it
/// a little: the variance lacks a part as 1/width, which is seen in two widths and put back. lags:
/// of the longest distance of peaks in its autocorrelation, which the width should exceed.
double squared_contrast(std::span<const double> frame, std::size_t lags = 0,
                        const CameraNoise& noise = {});

/// Of frames of one object, of the same pixels: the mean autocorrelation, the rms contrast, and the
/// grains of all. lags: so many of the autocorrelation, at most half of the pixels; its noise is
/// that of as many beyond. The camera's noise, without correlation, stands in the first value
/// alone, and is taken off there.
FrameStatistics frame_statistics(std::span<const std::vector<double>> frames, std::size_t lags,
                                 const CameraNoise& noise = {});
/// Of one.
FrameStatistics frame_statistics(std::span<const double> frame, std::size_t lags,
                                 const CameraNoise& noise = {});

}  // namespace flatspeckle::mc
