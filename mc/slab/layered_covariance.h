#pragma once

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/field_change.h"
#include "mc/jobs/path_job.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// slab_covariance() of a slab of layers (Layers), of plane waves in far views: each layer by
/// doubling, stacked by the star product (Redheffer). Paths of one scattering in closed form.
/// delay: k^2 D tau of the second field of each entry, of which each layer has its share.
Refined layered_covariance(const Scene& slab, bool reversed, const Refinement& refinement,
                           double delay = 0);

/// The same as a job, as slab_covariance_job(). Throws InputError for other media than layers, and
/// near ends.
FieldJob layered_covariance_job(const Scene& slab, bool reversed, const Refinement& refinement);

/// As slab_change_job(), of delays alone.
PathJob layered_change_job(const Scene& slab, bool reversed, const Refinement& refinement,
                           const std::vector<FieldChange>& changes);

}  // namespace flatspeckle::mc
