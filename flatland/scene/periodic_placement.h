#pragma once

#include "core/numbers/random.h"
#include "flatland/scene/scene.h"

namespace flatspeckle {

/// Draws a placement of a homogeneous scene in a box whose sides x = +-width/2 are joined: disks do
/// not overlap across them. Throws InputError for media that vary and under the conditions of
/// draw_placement().
Placement draw_periodic_placement(const Scene& scene, RandomStream& random);

}  // namespace flatspeckle
