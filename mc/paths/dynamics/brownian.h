#pragma once

#include <cstdint>
#include <vector>

#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/changed_fields.h"
#include "mc/jobs/motion.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::mc {

/// Throws InputError for a structure factor, and for negative delays.
void check_delays(const Scene& scene, const std::vector<double>& delays);

extern const DatasetTable delays_table;
/// With diffusion theory for light through a slab, where scatterers only diffuse. The request's
/// axes must have been written.
void write_delays(ResultFile& file, const Scene& scene, const std::vector<double>& delays,
                  const ChangeEstimates& found, const Motion& motion = {});

/// Diffusion theory of the correlation in transmission through a slab: motion is absorption 2 t (1
/// - g) mu_s, which is added to mu_a in the kappa^2 of C20. A limit for thick slabs and small t.
double diffusion_delay_correlation(const BulkMedium& medium, double thickness, double delay);

/// Fields of moving scatterers at two times (diffusing-wave spectroscopy; Pine et al. 1988). A
/// displacement's variance is 2 D tau along each axis, so that a scatterer that turns light by
/// theta multiplies a path's covariance by exp(-2 t (1 - cos theta)), t = k^2 D tau: the delays.
/// The scatterers move independently and little against a mean free path. Where they flow with a
/// velocity u, turning light from w to w' multiplies by exp(-i k (w - w').u t) as well. The job's
/// quantities are the intensity and the covariances of the fields at time 0 and after each delay,
/// which are real without flow. For an intensity request. Throws InputError for another, and for
/// negative delays.
PathJob delay_job(const Scene& scene, const Plan& plan, const std::vector<double>& delays,
                  std::uint64_t seed, const Motion& motion = {});

}  // namespace flatspeckle::mc
