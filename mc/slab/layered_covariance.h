#pragma once

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// slab_covariance() of a slab of layers (Layers), of plane waves in far views: each layer by
/// doubling, stacked by the star product (Redheffer). Paths of one scattering in closed form.
Refined layered_covariance(const Scene& slab, bool reversed, const Refinement& refinement);

/// The same as a job, as slab_covariance_job(). Throws InputError for other media than layers, and
/// near ends.
FieldJob layered_covariance_job(const Scene& slab, bool reversed, const Refinement& refinement);

}  // namespace flatspeckle::mc
