#pragma once

#include <span>
#include <vector>

#include "mc/imaging/recovery/camera_noise.h"
#include "mc/imaging/recovery/pair_peaks.h"

namespace flatspeckle::mc {

/// What the pixels of a frame tell without a reference.
struct FrameStatistics {
  double contrast = 0;  ///< standard deviation over mean, of what is left of the envelope
  double square = 0;  ///< of it, below 0 where the camera's noise happened to be less than expected
  double grain = 0;   ///< pixels, as grain_of()
  double grains = 0;  ///< in the frames
  double noise = 0;   ///< standard deviation of the autocorrelation where nothing is expected
  std::vector<double> autocorrelation;  ///< by lag in pixels, from 0
  PairPeaks peaks;
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
