#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// How a frame is divided by that of a reference point (Edrei and Scarcelli 2016).
struct DeconvolutionTask {
  enum class Method { wiener, richardson_lucy };
  Method method = Method::wiener;
  double regularisation = 0.3;  ///< Wiener: power of what is no picture, over that of the reference
  std::int64_t iterations = 100;  ///< Richardson and Lucy
};

/// An object as the frame shows it, by shift against the reference.
struct Deconvolved {
  /// At shifts of -(lags - 1) to lags - 1 pixels, in parts of the whole light: a Gaussian as wide
  /// as a grain of speckle for each point.
  std::vector<double> picture;
  double grain = 0;              ///< of the reference, pixels
  std::vector<double> residual;  ///< of the frame, rms over its mean, after each iteration
};

/// Standard deviation of a picture's points: that of speckle of such a grain.
inline double point_width(double grain) {
  return grain / 2;
}

/// Both frames of the same pixels, over their smooth envelopes. Throws InputError as
/// without_envelope().
Deconvolved deconvolved(std::span<const double> frame, std::span<const double> reference,
                        std::size_t lags, const DeconvolutionTask& task);

/// What noise and a filter's reach are measured by: the mean of a spectrum's power, weighted by
/// itself; for one that is drawn (exponentially distributed) half of it.
double typical_power(std::span<const double> power);

/// The picture of points at these shifts in pixels, as a deconvolution should have it.
std::vector<double> point_picture(const LineObject& shifts, std::size_t lags, double grain);

/// Peak signal-to-noise ratio in dB: the largest value of the true picture over the rms of what it
/// differs by from the other, whose scale is free. noise: variance that each value of that has
/// besides.
double psnr(std::span<const double> truth, std::span<const double> picture, double noise = 0);

}  // namespace flatspeckle::mc
