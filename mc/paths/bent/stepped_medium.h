#pragma once

#include "mc/paths/bent/graded_medium.h"

namespace flatspeckle::mc {

/// Index fields of grin in the plane y = 0, parabolic, blobs, ultrasound and grid, by steps along
/// rays. Waves of ends are tables over the box; a point in it, or close by, finds the ray to each
/// place anew.
std::shared_ptr<const GradedMedium> stepped_medium(const Scene& scene);

}  // namespace flatspeckle::mc
