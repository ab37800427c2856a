#pragma once

#include "mc/slab/refinement.h"
#include "mc/space/space_chains.h"
#include "mc/space/space_slab.h"

namespace flatspeckle::mc {

/// The covariance per illuminated area, per entry, of scalar waves in space (conventions, C41): as
/// slab_covariance() in the plane, by the same doubling. Polar ordinates and modes of the azimuth
/// are refined until each alone changes nothing; the tolerance is relative to scales(). Number:
/// double, Complex for two frequencies, or Dual<double>, whose derivatives follow the values.
template <typename Number>
Refined space_covariance(const SpaceSlabOf<Number>& slab, const SpaceRequest& request,
                         bool reversed, const Refinement& refinement);

}  // namespace flatspeckle::mc
