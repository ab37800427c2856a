#pragma once

#include <cstdint>
#include <vector>

#include "core/result/dataset_row.h"
#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/walk/plan.h"

namespace flatspeckle::mc {

/// Fields of diffusing scatterers at two times (diffusing-wave spectroscopy; Pine et al. 1988). A
/// displacement's variance is 2 D tau along each axis, so that a scatterer that turns light by
/// theta multiplies a path's covariance by exp(-2 t (1 - cos theta)), t = k^2 D tau: the delays.
/// The scatterers move independently and little against a mean free path.
struct DelayJob {
  FieldJob field;         ///< the intensities, at no delay
  Estimator covariance;   ///< of the fields at time 0 and after each delay, [delay][channel]; real
  Estimator correlation;  ///< that over the intensity; 0 where there is none
};

/// For an intensity request. Throws InputError for another, and for negative delays.
DelayJob delay_job(const Scene& scene, const Plan& plan, const std::vector<double>& delays,
                   std::uint64_t seed);

/// The two, [delay][channel].
struct DelayEstimates {
  Estimate covariance, correlation;
};
DelayEstimates delay_estimates(const DelayJob& job, const GroupedSums& sums);

extern const DatasetTable delays_table;
/// With diffusion theory for light through a slab. The request's axes must have been written.
void write_delays(ResultFile& file, const Scene& scene, const std::vector<double>& delays,
                  const DelayEstimates& found);

/// Diffusion theory of the correlation in transmission through a slab: motion is absorption 2 t (1
/// - g) mu_s, which is added to mu_a in the kappa^2 of C20. A limit for thick slabs and small t.
double diffusion_delay_correlation(const BulkMedium& medium, double thickness, double delay);

}  // namespace flatspeckle::mc
