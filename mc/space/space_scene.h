#pragma once

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/space/space_covariance.h"

namespace flatspeckle::mc {

/// A slab that has the same keys in space: lights and views lie in the plane of incidence, the
/// medium has a phase function per steradian, and its `dimension` says so. Throws InputError for
/// boxes, and for scatterers of the plane: what may be in space is hg, two_term_hg, phase_table and
/// rayleigh.
Scene in_space(Scene slab, const ScattererValues& values);

/// Of a scene in space, whose second fields are recorded after a delay (SpaceLaw).
SpaceSlab space_slab(const Scene& scene, double delay = 0);

/// space_covariance() as a job (two_batches()); the tolerance holds for a range too.
FieldJob space_covariance_job(const Scene& scene, bool reversed, const Refinement& refinement);

/// Quantities as those of delay_job(): the entries without delay, then with each.
PathJob space_delay_job(const Scene& scene, bool reversed, const Refinement& refinement,
                        const std::vector<double>& delays);

}  // namespace flatspeckle::mc
