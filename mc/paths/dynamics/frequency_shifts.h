#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/changed_fields.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

extern const DatasetTable frequency_table;
/// Into a group (empty: the root); of one field, with diffusion theory for light through a slab.
/// The request's axes and that of the shifts must have been written.
void write_frequency_shifts(ResultFile& file, const std::string& group, const Scene& scene,
                            const std::vector<double>& shifts, const ChangeEstimates& found);
void write_shift_axis(ResultFile& file, const std::vector<double>& shifts);

/// Diffusion theory of the magnitude of the correlation in transmission through a slab: a
/// difference of wavenumbers is absorption i (k2 - k1), which is added to mu_a in the kappa^2 of
/// C20. A limit for thick slabs.
double diffusion_frequency_correlation(const Scene& slab, double shift);

/// Fields at two frequencies by walks (conventions, C39): the inner flights of a path turn the
/// phase of its covariance by (k1 - k2) times their length, its ends have each its own k. The job's
/// quantities are the covariance, then that with the fields at each shifted frequency, 0 where
/// entries do not change. The shifts have been checked (check_frequency_shifts()).
PathJob frequency_job(const Scene& scene, const Plan& plan, const std::vector<double>& shifts,
                      std::uint64_t seed);
/// The scene's plan, with phases.
Plan frequency_plan(const Scene& scene, ReversedPaths reversed);

}  // namespace flatspeckle::mc
