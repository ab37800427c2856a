#pragma once

#include "flatland/scene/scene.h"
#include "mc/jobs/flux_job.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// Transport of intensity through a slab without chance: what flux_job() estimates, per light its
/// shares and the share that leaves in each bin of the exit angle, in space the polar one from +z.
/// The tolerance is relative to reflectance and transmittance.
Refined slab_flux(const Scene& slab, std::size_t angle_bins, const Refinement& refinement);

/// What slab_flux() solves as a job (two_batches()).
FluxJob slab_flux_job(const Scene& slab, std::size_t angle_bins, const Refinement& refinement);

}  // namespace flatspeckle::mc
