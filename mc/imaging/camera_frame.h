#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"

namespace flatspeckle::mc {

/// What a camera adds to the light. Frames are in units of the light's mean over the pixels.
struct CameraNoise {
  double photons = 0;     ///< detected per pixel, mean of the light; 0: no shot noise
  double read_noise = 0;  ///< standard deviation, in photons
  double background = 0;  ///< even light besides, over the mean
};

/// Of what expose() adds, over the square of the mean.
double noise_variance(const CameraNoise& noise);

/// sum over the points n of brightness_n |u_n|^2, over its mean. field: [point][pixel].
std::vector<double> incoherent_sum(std::span<const Complex> field,
                                   std::span<const double> brightness);

/// The frame as the camera has it.
void expose(std::vector<double>& frame, const CameraNoise& noise, RandomStream& random);

}  // namespace flatspeckle::mc
