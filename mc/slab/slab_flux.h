#pragma once

#include "flatland/scene/scene.h"
#include "mc/jobs/flux_job.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// Transport of intensity through a slab without chance: what flux_job() estimates, per light its
/// shares and the share that leaves in each bin of the exit angle, in space the polar one from +z.
/// The tolerance is relative to reflectance and transmittance.
Refined slab_flux(const Scene& slab, std::size_t angle_bins, const Refinement& refinement);

/// How much the shares of light, with what is not scattered, exceed 1, and the error of their sum:
/// of the light for which that is most.
struct PowerBalance {
  double imbalance = 0, error = 0;
};
/// The balance of shares as slab_flux() returns them, or Monte Carlo estimates them. No share
/// follows from the others, so that a wrong one shows.
PowerBalance power_balance(const Scene& slab, const FluxEstimates& flux);
/// The balance of a slab's plane waves, which are solved for it: what `covariance` and curves by
/// transport can check. It costs one slab_flux() with one bin.
PowerBalance slab_power_balance(const Scene& slab, const Refinement& refinement);

/// What slab_flux() solves as a job (two_batches()).
FluxJob slab_flux_job(const Scene& slab, std::size_t angle_bins, const Refinement& refinement);

}  // namespace flatspeckle::mc
