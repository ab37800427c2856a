#pragma once

#include "mc/space/space_covariance.h"

namespace flatspeckle::mc {

/// Shares of a plane wave's power that leave a slab in space diffusely; of the value and of its
/// difference from fewer ordinates.
struct SpaceFlux {
  double reflected, transmitted;
  double difference;  ///< the larger of the two
};

/// angle: of the light to the normal, below pi/2. The tolerance is absolute.
SpaceFlux space_flux(const SpaceSlab& slab, double angle, const Refinement& refinement);

}  // namespace flatspeckle::mc
