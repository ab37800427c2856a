#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/changed_fields.h"
#include "mc/jobs/motion.h"

namespace flatspeckle::mc {

/// Throws InputError for a structure factor, and for negative delays.
void check_delays(const Scene& scene, const std::vector<double>& delays);

/// Of each value; its error is not smaller than that of the magnitude.
Estimate magnitude(Estimate estimate);

extern const DatasetTable delays_table;
/// With diffusion theory for light through a slab, where scatterers only diffuse. The request's
/// axes must have been written.
void write_delays(ResultFile& file, const Scene& scene, const std::vector<double>& delays,
                  const ChangeEstimates& found, const Motion& motion = {});

/// Diffusion theory of the correlation in transmission through a slab: motion is absorption 2 t (1
/// - g) mu_s, which is added to mu_a in the kappa^2 of C20. A limit for thick slabs and small t.
double diffusion_delay_correlation(const BulkMedium& medium, double thickness, double delay);

}  // namespace flatspeckle::mc
