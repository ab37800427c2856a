#pragma once

#include "mc/space/space_chains.h"
#include "mc/space/space_law.h"
#include "mc/transport/refinement.h"

namespace flatspeckle::mc {

/// A slab in space. Lengths in one unit.
struct SpaceSlab {
  double k, mu_t, depth, albedo;
  SpaceLaw law;

  double optical_depth() const { return mu_t * depth; }
};

/// The covariance per illuminated area, per entry, of scalar waves in space (conventions, C41): as
/// slab_covariance() in the plane, by the same doubling. Polar ordinates and modes of the azimuth
/// are refined until each alone changes nothing; the tolerance is relative to scales().
Refined space_covariance(const SpaceSlab& slab, const SpaceRequest& request, bool reversed,
                         const Refinement& refinement);

}  // namespace flatspeckle::mc
