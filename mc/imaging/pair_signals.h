#pragma once

#include <vector>

#include "mc/imaging/recovery/camera_noise.h"
#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// What a frame is measured by.
struct FrameGrains {
  double grains = 0;       ///< independent ones in it
  CameraNoise noise = {};  ///< of its
  double pixels = 1;
};

/// Heights of the pairs' peaks in the autocorrelation over its noise. A peak is a_ij = C_I b_i b_j
/// / (sum of b)^2, that at lag 0 a_0 = (sum of b^2) / (sum of b)^2, both less by (1 +
/// background)^2; the noise of an estimated autocorrelation is that of all its peaks and of the
/// camera, whose variance w stands at lag 0 alone: sqrt((a_0^2 + 2 sum of a_ij^2) / grains + (2 a_0
/// w + w^2) / pixels) (Bartlett's formula; distances distinct). For N equal points of C_I without
/// camera that is C_I sqrt(grains) / N / sqrt(1 + C_I^2 (1 - 1/N)).
std::vector<double> peaks_over_noise(const LineObject& object,
                                     const std::vector<double>& correlation,
                                     const FrameGrains& frame);

/// As peaks_over_noise(), in the filtered autocorrelation that is searched (pair_peaks()). The
/// filter has H = T / P, P = a_0 T + w, T the power of speckle of unit variance in `band` cycles
/// per pixel: the peaks' variance is the integral of H^2 ((a_0^2 + 2 sum of a_ij^2) T^2 + 2 a_0 w T
/// + w^2) / pixels, over the square of the integral of H T.
std::vector<double> filtered_peaks_over_noise(const LineObject& object,
                                              const std::vector<double>& correlation,
                                              const FrameGrains& frame, double band);

}  // namespace flatspeckle::mc
