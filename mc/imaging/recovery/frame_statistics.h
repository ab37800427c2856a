#pragma once

#include <span>
#include <vector>

#include "core/result/invariant.h"
#include "mc/theory/detector_noise.h"

namespace flatspeckle::mc {

double mean_of(std::span<const double> values);

/// Speckle of light from a uniform band of directions has the autocorrelation sinc^2(band lag). Its
/// power spectrum is a triangle that ends at `band` cycles per pixel.

/// Returns the autocorrelation of speckle of unit variance at a lag in pixels.
double speckle_peak(double lag, double band);
/// Returns the power spectrum of speckle of unit variance at a frequency in cycles per pixel. If
/// the pixels are too coarse, it includes aliasing.
double speckle_power(double frequency, double band);
/// Returns the size of a grain in pixels: the sum of the squared autocorrelation over all lags.
/// This size determines the error of averages over a frame. It is 2 / (3 band) if grains are larger
/// than pixels.
double grain_of(double band);

/// Returns the band for which speckle_peak() is the most significant part of an autocorrelation
/// about lag 0. Its fitted height must be at least half of the value at lag 0; if no band fits, the
/// result is 0. The peak may stand on a wider base, as in speckle of few paths. noise: standard
/// deviation at lags other than 0. At lag 0 the variance is 2 + white times as large, where white
/// is the variance of the camera's photon number divided by its squared mean (Poisson
/// distribution).
double fitted_band(std::span<const double> autocorrelation, double noise, double white = 0);

/// The peaks of pairs of points as a function of their distance: the autocorrelation, filtered to
/// suppress camera noise, which is uncorrelated between pixels.
struct PairPeaks {
  double step = 1;  ///< distance from one lag to the next, in pixels: about a third of a grain
  std::vector<double> height;  ///< height of the peak of a pair at each lag
  double noise = 0;            ///< rms noise of the heights of the pair peaks
  /// Autocorrelation at lag 0, (sum of b^2) / (sum of b)^2 for points of brightness b.
  double alone = 0;
  /// Width of a filtered peak in pixels, defined like the grain size; at most 4/3 of the grain
  /// size.
  double width = 1;
};

/// Parameters of an estimated autocorrelation.
struct AutocorrelationTerms {
  double alone = 0, white = 0;  ///< values at lag 0 due to the light and to camera noise
  double band = 1;              ///< band of the speckle, in cycles per pixel
};

/// Subtracts the peak about lag 0 from an autocorrelation and filters the rest. The power spectrum
/// of a frame is P = a T + w, with T the spectrum of speckle of unit variance, a = terms.alone its
/// variance and w = terms.white the spectrum of the camera's noise. The noise of
/// the autocorrelation then has the spectrum P^2 / pixels (Bartlett's formula), and the peak of a
/// pair has the spectrum T. Among the filters T / P^n, n = 2 is optimal in Gaussian noise, but its
/// result rings if the camera has no noise and two pairs have similar distances. This function uses
/// n = 1, which leaves an autocorrelation without camera noise unchanged. autocorrelation: by lag
/// in pixels, with the camera's noise subtracted at lag 0. Between `lags` and twice `lags` it must
/// contain only noise.
PairPeaks pair_peaks(std::span<const double> autocorrelation, std::size_t lags,
                     const AutocorrelationTerms& terms);

/// Statistics of the pixels of one or several frames.
struct FrameStatistics {
  /// Standard deviation divided by the mean, for the frame divided by its envelope.
  double contrast = 0;
  double square = 0;  ///< squared contrast; negative if the camera's noise was less than expected
  double grain = 0;   ///< grain size in pixels (grain_of())
  double grains = 0;  ///< number of grains in all frames
  double noise = 0;   ///< standard deviation of the autocorrelation at lags without signal
  std::vector<double> autocorrelation;  ///< by lag in pixels, from 0
  PairPeaks peaks;
  /// Check: relative difference between the autocorrelation at lag 0 and the variance of the
  /// pixels.
  Invariant variance;
};

/// Returns the frame divided by its smooth envelope, minus 1. The envelope is a Gaussian average
/// with a standard deviation of `width` pixels. Throws InputError for a frame whose envelope is not
/// positive.
std::vector<double> without_envelope(std::span<const double> frame, double width);

/// Returns the width of the envelope for autocorrelations: twice the lags, but at most 1/32 of the
/// frame or 32 pixels, whichever is larger. With a wider envelope, slow variations would remain as
/// a pedestal under all peaks. The pedestal would be higher at short lags and bias a search towards
/// short objects.
double envelope_width(std::size_t pixels, std::size_t lags);

/// Returns the squared contrast of a frame: the variance of the frame divided by its envelope, less
/// the variance of the camera's noise, for which the envelope determines the shot noise. Only the
/// inner part of the frame is used, one half to three quarters of its length; the frame must have
/// at least 64 pixels. An envelope that is estimated from the speckle itself follows the speckle
/// slightly, so that the variance is too small by an amount proportional to 1/width. This amount is
/// measured with two widths and corrected. lags: longest distance of peaks in the autocorrelation,
/// which the width of the envelope should exceed.
double squared_contrast(std::span<const double> frame, std::size_t lags = 0,
                        const CameraNoise& noise = {});

/// Computes the statistics of frames of one object, which have the same number of pixels: the mean
/// autocorrelation, the rms contrast, and the total number of grains. lags: number of lags of the
/// autocorrelation, at most half the number of pixels. The noise is estimated from the next `lags`
/// lags. The camera's noise is uncorrelated between pixels; it affects only the value at lag 0,
/// from which it is subtracted.
FrameStatistics frame_statistics(std::span<const std::vector<double>> frames, std::size_t lags,
                                 const CameraNoise& noise = {});
/// Computes the statistics of one frame.
FrameStatistics frame_statistics(std::span<const double> frame, std::size_t lags,
                                 const CameraNoise& noise = {});

}  // namespace flatspeckle::mc
