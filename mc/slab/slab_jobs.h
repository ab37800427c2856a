#pragma once

#include <vector>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/changed_fields.h"
#include "mc/jobs/gradient_job.h"
#include "mc/jobs/path_job.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

// What slab_covariance.h solves as jobs of two batches (two_batches()). All throw InputError for
// media that vary other than by layers, and for near ends of layers.

/// The tolerance holds for the range of a memory_effect request too.
FieldJob slab_covariance_job(const Scene& scene, bool reversed, const Refinement& refinement);

/// As the gradient_job() of Monte Carlo.
GradientJob slab_gradient_job(const Scene& scene, bool reversed, const Refinement& refinement);

/// Quantities as those of delay_job(): the entries without change, then with each.
PathJob slab_change_job(const Scene& scene, bool reversed, const Refinement& refinement,
                        const std::vector<FieldChange>& changes);

}  // namespace flatspeckle::mc
