#pragma once

#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/field_change.h"
#include "mc/jobs/gradient_job.h"
#include "mc/jobs/path_job.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// The covariance of C14 and C18 on a slab, per entry of the request, as linear transport of pairs
/// at one transverse frequency (conventions, C35 to C40): what covariance_job() estimates, single
/// scattering in closed form. reversed: with reversed paths (C38). The tolerance is relative to the
/// entry, or to the root of its two intensities (or that which the request has) where that is more.
/// change: of the second field of each entry.
Refined slab_covariance(const Scene& slab, bool reversed, const Refinement& refinement,
                        const FieldChange& change = {});

/// The same as a job (two_batches()); the tolerance holds for a range too (range_refinement.h).
FieldJob slab_covariance_job(const Scene& slab, bool reversed, const Refinement& refinement);

/// Values per entry, then derivatives by a parameter: exact, of the doubling itself. The tolerance
/// of a derivative is relative to the entry where that is more than what a relative change of the
/// parameter makes. The slab scatters.
Refined slab_slopes(const Scene& slab, bool reversed, const Refinement& refinement,
                    BulkParameter parameter);

/// As the gradient_job() of Monte Carlo.
GradientJob slab_gradient_job(const Scene& slab, bool reversed, const Refinement& refinement);

/// Quantities as those of delay_job(): the entries without change, then with each.
PathJob slab_change_job(const Scene& slab, bool reversed, const Refinement& refinement,
                        const std::vector<FieldChange>& changes);

}  // namespace flatspeckle::mc
