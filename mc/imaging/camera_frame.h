#pragma once

#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"
#include "mc/imaging/recovery/camera_noise.h"

namespace flatspeckle::mc {

/// sum over the points n of brightness_n |u_n|^2. field: [point][pixel].
std::vector<double> sum_of_intensities(std::span<const Complex> field,
                                       std::span<const double> brightness);

/// The same over its mean.
std::vector<double> incoherent_sum(std::span<const Complex> field,
                                   std::span<const double> brightness);

/// The frame as the camera has it.
void expose(std::vector<double>& frame, const CameraNoise& noise, RandomStream& random);

}  // namespace flatspeckle::mc
