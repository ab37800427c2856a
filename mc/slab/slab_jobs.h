#pragma once

#include <vector>

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/changed_fields.h"
#include "mc/jobs/gradient_job.h"
#include "mc/jobs/path_job.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

// Jobs of two batches (two_batches()) that contain the solutions of slab_covariance.h. All
// functions throw InputError for media that vary other than in layers, and for near endpoints with
// layers.

/// Makes a job of the covariance. For a memory_effect request the tolerance also applies to the
/// range of the memory effect.
FieldJob slab_covariance_job(const Scene& scene, bool reversed, const Refinement& refinement);

/// Makes a job of the quantities that gradient_job() estimates by Monte Carlo.
GradientJob slab_gradient_job(const Scene& scene, bool reversed, const Refinement& refinement);

/// Makes a job of the quantities of delay_job(): the entries for two equal fields, then for each
/// change of the second field.
PathJob slab_change_job(const Scene& scene, bool reversed, const Refinement& refinement,
                        const std::vector<FieldChange>& changes);

}  // namespace flatspeckle::mc
