#pragma once

#include <memory>

#include "grin/estimators/path_kernels.h"
#include "grin/space/curved_space.h"

namespace flatspeckle::grin {

// The light of beams that reaches the sensor without a collision. Only light paths make it, so that
// walks leave it out (Bidirectional), and it is summed apart: with its transmittance instead of by
// chance, and from points spread evenly over the beams (the additive sequence of the plastic
// number, whose points fill a square; shifted at random for each batch).
//
// The space is that of without_scattering(stage), where each flight goes to the boundary.

PathKernel beams_kernel(bool timed, std::shared_ptr<const Transport> transport, double excess);

/// random_phase: each ray meets its own phase of the sound.
PathKernel beams_kernel(bool timed, std::shared_ptr<const Transport> transport,
                        std::shared_ptr<const CurvedSpace> space, bool random_phase);

}  // namespace flatspeckle::grin
