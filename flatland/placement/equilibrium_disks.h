#pragma once

#include <span>
#include <vector>

#include "core/numbers/random.h"
#include "flatland/media/domain.h"

namespace flatspeckle {

/// Centres of hard disks from the equilibrium fluid in a box with periodic edges: the box is a
/// window on a homogeneous fluid without walls, of uniform density. (Distances in the plane are no
/// shorter than periodic ones, so nothing overlaps there either.)
/// Radii include half of the gap that disks are to keep; they may differ, the largest first. A pure
/// function of the random numbers. Preconditions: packing fraction up to 0.69 (above, the fluid
/// freezes), a box at least three of the largest diameters wide and deep. Throws InputError where
/// disks of very different size find no place.
std::vector<Vec2> draw_equilibrium_disks(const Domain& box, std::span<const double> radii,
                                         RandomStream& random);

}  // namespace flatspeckle
