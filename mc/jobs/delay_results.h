#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/changed_fields.h"
#include "mc/jobs/crossings.h"
#include "mc/jobs/dynamics.h"

namespace flatspeckle::mc {

/// Throws InputError for scatterers with a structure factor, for negative delays, and for materials
/// with their own factors on the velocity if nothing flows.
void check_delays(const Scene& scene, const std::vector<double>& delays, const Motion& motion);

/// Estimates from a job of two fields with delays between them.
struct DelayEstimates {
  ChangeEstimates changes;
  /// g2 - 1 = beta |g1|^2, [delay][channel], and the delays at which |g1| is 1/e; for an intensity
  /// request.
  Estimate intensity;
  Crossings decay;
};
DelayEstimates delay_estimates(const CovarianceRequest& request, const PathJob& job,
                               const GroupedSums& sums, const Dynamics& dynamics);

extern const DatasetTable delays_table;
/// Writes the delays, and the diffusion constant to which they refer.
void write_delay_axis(ResultFile& file, const Dynamics& dynamics);
/// Writes the covariances and correlations after each delay and, for light transmitted or reflected
/// by a slab whose scatterers only diffuse, the correlations of diffusion theory. The axes of the
/// request must have been written before.
void write_delays(ResultFile& file, const Scene& scene, const Dynamics& dynamics,
                  const DelayEstimates& found);

}  // namespace flatspeckle::mc
