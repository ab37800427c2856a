#pragma once

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/slab/transport_jobs.h"
#include "mc/space/space_covariance.h"

namespace flatspeckle::mc {

/// A slab that has the same keys in space: lights and views lie in the plane of incidence, the
/// medium has a phase function per steradian, and its `dimension` says so. Throws InputError for
/// boxes, and for scatterers of the plane: what may be in space is hg, two_term_hg, phase_table,
/// rayleigh and mie, whose albedo is that of its spheres.
Scene in_space(Scene slab, const ScattererValues& values);

/// Of a scene in space, whose second fields are recorded after a delay (SpaceLaw).
SpaceSlab space_slab(const Scene& scene, double delay = 0);

/// Of a scene in space, as slab_covariance() and slab_slopes() of the plane; so are the jobs.
Refined space_covariance(const Scene& scene, bool reversed, const Refinement& refinement,
                         const FieldChange& change = {});
Refined space_slopes(const Scene& scene, bool reversed, const Refinement& refinement,
                     BulkParameter parameter);

FieldJob space_covariance_job(const Scene& scene, bool reversed, const Refinement& refinement);
PathJob space_change_job(const Scene& scene, bool reversed, const Refinement& refinement,
                         const std::vector<FieldChange>& changes);
GradientJob space_gradient_job(const Scene& scene, bool reversed, const Refinement& refinement);

}  // namespace flatspeckle::mc
