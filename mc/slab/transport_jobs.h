#pragma once

#include <functional>
#include <vector>

#include "mc/jobs/field_change.h"
#include "mc/jobs/gradient_job.h"
#include "mc/jobs/path_job.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// Quantities as those of delay_job(): what `solve` gives per entry without change, then with each.
PathJob change_job(std::size_t entries, const std::vector<FieldChange>& changes,
                   const std::function<Refined(const FieldChange&)>& solve);

/// As the gradient_job() of Monte Carlo. solve: values per entry, then derivatives.
GradientJob slope_job(const Scene& scene, const std::function<Refined(BulkParameter)>& solve);

}  // namespace flatspeckle::mc
