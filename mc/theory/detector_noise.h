#pragma once

#include <functional>
#include <vector>

namespace flatspeckle::mc {

/// Noise and background of a camera. Frames are in units of the light's mean over the pixels.
struct CameraNoise {
  /// Mean number of photons of the light detected per pixel, without background; 0: no noise.
  double photons = 0;
  double read_noise = 0;  ///< standard deviation of the read noise, in photons
  double background = 0;  ///< uniform background light, divided by the mean of the light
};

/// Returns the variance of the camera's noise divided by the squared mean, for pixels whose mean is
/// `times` the mean of the frame.
inline double noise_variance(const CameraNoise& noise, double times = 1) {
  if (noise.photons == 0) return 0;
  const double mean = times * (1 + noise.background) * noise.photons;
  return (mean + noise.read_noise * noise.read_noise) / (mean * mean);
}

/// Fluctuations of polarised light in square pixels that adjoin. The correlation of the intensity
/// at two points is exp(-pi r^2 / area of a speckle).
struct PixelSpeckle {
  double modes;    ///< squared mean / variance of the light in a pixel [goodman2007]
  double squares;  ///< sum over all pixels of the squared correlation with the light in one of them
};
/// area: that of a pixel divided by that of a speckle, at least 0.01.
PixelSpeckle pixel_speckle(double area);

/// Function of a delay of at least 0 that decays from 1.
using Decay = std::function<double(double)>;

/// Returns the sum over exposures, which follow each other without gaps, of the squared correlation
/// with the light of one of them. square: |g1|^2. contrast: K^2 of an exposure divided by beta (see
/// Exposure).
double successive_exposures(const Decay& square, double exposure, double contrast, double frames);

/// Light that the pixels of a camera count in an exposure.
struct CountedSpeckle {
  double photons;     ///< mean of the detected photons per pixel
  double contrast;    ///< squared contrast K^2 of the light
  double read_noise;  ///< standard deviation, in photons
  /// Sum over all pixels and exposures of the squared correlation with one of them; 1 if they are
  /// independent.
  double squares = 1;
};

/// Returns the variance of an estimate of K^2, multiplied by the number of pixels and exposures
/// from which it is made. The estimate is (variance - read_noise^2)/mean^2 - 1/mean of the counts.
/// The intensity has the cumulants of a gamma distribution [goodman2007]. For small K^2 and
/// independent pixels the result is 2 (K^2 + noise_variance())^2, as in speckle contrast optical
/// spectroscopy [zilpelwar2022].
double contrast_variance(const CountedSpeckle& light);

/// Noise of the intensity correlation g2 of photons that a detector counts. The light is circular
/// Gaussian, with the coherence factor beta. For small beta and exponential decay, and bins much
/// shorter than the decay, the variance is that of [koppel1974], which diffuse correlation
/// spectroscopy uses [zhou2006].
class CorrelationNoise {
 public:
  /// rate: detected photons per unit of time. field: g1, which is negligible after `longest` and
  /// smooth at delays below `shortest`.
  CorrelationNoise(double rate, double beta, Decay field, double shortest, double longest);

  /// Returns the covariance of g2 at two delays, multiplied by the averaging time, without the
  /// noise of pairs of photons. It does not depend on the widths of bins.
  double covariance(double delay, double other) const;
  /// Returns the variance due to the number of pairs of photons, multiplied by the averaging time.
  /// bin: width of the bin of delays.
  double pair_noise(double delay, double bin) const;

 private:
  double rate_, beta_;
  Decay field_;
  std::vector<double> time_, weight_;  ///< quadrature from -longest to longest
};

}  // namespace flatspeckle::mc
