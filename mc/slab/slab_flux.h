#pragma once

#include "flatland/scene/scene.h"
#include "mc/jobs/flux_job.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// Solves the transport of intensity through a slab deterministically, for the quantities that
/// flux_job() estimates: for each illumination, the shares of its power (FluxShare), then the share
/// that leaves in each bin of the exit angle. In space the exit angle is the polar angle from +z.
/// The tolerance is relative to reflectance and transmittance.
Refined slab_flux(const Scene& slab, std::size_t angle_bins, const Refinement& refinement);

/// Returns the solution of slab_flux() as a job (two_batches()).
FluxJob slab_flux_job(const Scene& slab, std::size_t angle_bins, const Refinement& refinement);

}  // namespace flatspeckle::mc
