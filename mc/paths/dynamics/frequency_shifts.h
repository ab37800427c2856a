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
/// Writes the covariances and correlations for each frequency shift into a group of the file
/// (empty: the root) and, for an intensity request with light transmitted through a homogeneous
/// slab, the correlations of diffusion theory. The axes of the request and of the shifts must have
/// been written before.
void write_frequency_shifts(ResultFile& file, const std::string& group, const Scene& scene,
                            const std::vector<double>& shifts, const ChangeEstimates& found);
void write_shift_axis(ResultFile& file, const std::vector<double>& shifts);

/// Returns the magnitude of the correlation of fields transmitted through a slab at wavenumbers k1
/// and k2 = k1 (1 + shift), by diffusion theory. The difference of the wavenumbers acts as an
/// absorption i (k2 - k1), which is added to mu_a in kappa^2 of C20. The result is the limit for
/// thick slabs.
double diffusion_frequency_correlation(const Scene& slab, double shift);

/// Makes a job that samples walks for fields at two frequencies (conventions, C39). The free
/// flights between the scatterers of a path rotate the phase of its covariance by (k1 - k2) times
/// their total length, and the endpoint factors of each field contain the wavenumber of that field.
/// The quantities are the covariance, then for each shift the covariance of the first field with
/// the second field at the shifted frequency. The latter is 0 for entries without a shifted second
/// field (changing_entries()). The shifts must have been checked (check_frequency_shifts()).
PathJob frequency_job(const Scene& scene, const Plan& plan, const std::vector<double>& shifts,
                      std::uint64_t seed);
/// Makes the plan for frequency_job(), as make_plan() does, but always with phases.
Plan frequency_plan(const Scene& scene, ReversedPaths reversed);

}  // namespace flatspeckle::mc
