#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// Settings for the deconvolution of a frame by the frame of a reference point [edrei2016].
struct DeconvolutionTask {
  enum class Method { wiener, richardson_lucy };
  Method method = Method::wiener;
  double regularisation = 0.3;    ///< Wiener: noise power divided by the power of the reference
  std::int64_t iterations = 100;  ///< number of Richardson-Lucy iterations
};

/// An object reconstructed from a frame, as a function of the shift relative to the reference.
struct Deconvolved {
  /// Values at shifts of -(lags - 1) to lags - 1 pixels, as fractions of the total light: for each
  /// point a Gaussian as wide as a speckle grain.
  std::vector<double> picture;
  double grain = 0;  ///< grain size of the reference in pixels
  /// Rms difference between frame and model, divided by the mean of the frame, at each iteration.
  std::vector<double> residual;
};

/// Returns the standard deviation of the Gaussian that represents a point in a picture, in pixels.
/// It corresponds to speckle with this grain size.
inline double point_width(double grain) {
  return grain / 2;
}

/// Reconstructs an object from two frames with the same pixels, which are first divided by their
/// smooth envelopes. Throws InputError if without_envelope() does.
Deconvolved deconvolved(std::span<const double> frame, std::span<const double> reference,
                        std::size_t lags, const DeconvolutionTask& task);

/// Returns the mean of a power spectrum, weighted by the power itself. The noise level of the
/// Wiener filter is relative to this mean. If the power is random and exponentially distributed,
/// the weighted mean is twice the unweighted mean.
double typical_power(std::span<const double> power);

/// Returns the ideal picture of points at these shifts in pixels.
std::vector<double> point_picture(const LineObject& shifts, std::size_t lags, double grain);

/// Returns the peak signal-to-noise ratio in dB: the largest value of the true picture, divided by
/// the rms difference from the other picture, which is first scaled to fit best. noise: additional
/// variance of each value of the other picture.
double psnr(std::span<const double> truth, std::span<const double> picture, double noise = 0);

}  // namespace flatspeckle::mc
