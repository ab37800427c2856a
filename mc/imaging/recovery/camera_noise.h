#pragma once

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

}  // namespace flatspeckle::mc
