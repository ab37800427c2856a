#pragma once

namespace flatspeckle::mc {

/// What a camera adds to the light. Frames are in units of the light's mean over the pixels.
struct CameraNoise {
  double photons = 0;     ///< detected per pixel, mean of the light; 0: no shot noise
  double read_noise = 0;  ///< standard deviation, in photons
  double background = 0;  ///< even light besides, over the mean
};

/// Of what the camera adds, over the square of the mean, where that is so many times the mean of
/// the frame.
inline double noise_variance(const CameraNoise& noise, double times = 1) {
  if (noise.photons == 0) return 0;
  const double mean = times * (1 + noise.background) * noise.photons;
  return (mean + noise.read_noise * noise.read_noise) / (mean * mean);
}

}  // namespace flatspeckle::mc
