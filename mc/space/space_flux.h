#pragma once

#include "flatland/scene/scene.h"
#include "mc/jobs/flux_job.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// Of a scene in space, as slab_flux() of the plane: bins are of the polar angle, from +z, over
/// (0, pi).
Refined space_flux(const Scene& slab, std::size_t angle_bins, const Refinement& refinement);

/// The same as a job (two_batches()).
FluxJob space_flux_job(const Scene& slab, std::size_t angle_bins, const Refinement& refinement);

}  // namespace flatspeckle::mc
