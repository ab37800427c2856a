#pragma once

#include <cstddef>
#include <span>

#include "mc/imaging/line_camera.h"
#include "mc/imaging/recovery/camera_noise.h"

namespace flatspeckle::mc {

/// What a picture by Wiener's filter is expected to be, without one: its PSNR in dB.
///
/// A point's speckle is that of the reference, shifted, times C_I (to_reference), and something
/// else of variance 1 - C_I^2; that part of the frame is lost, too, whose speckle has left the
/// reference's. Speckle has a triangle as its power spectrum, up to the grains that
/// the camera can see; the power of one frequency is distributed exponentially, over which the
/// filter's response and what it lets through are averaged. Shot and read noise are white.
double predicted_psnr(const LineScene& line, std::span<const double> to_reference,
                      const CameraNoise& noise, std::size_t lags, double regularisation);

}  // namespace flatspeckle::mc
