#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result/dataset_row.h"
#include "mc/estimators/bulk_parameter.h"
#include "mc/estimators/path_job.h"

namespace flatspeckle::mc {

/// Derivatives of a scene's covariance from the paths that estimate it: the integrand of C14 is
/// differentiated, the density that the paths are drawn from is not. The parameters are mu_t, g and
/// albedo where they describe the scatterers as a bulk (all for hg, no g for points, mu_t alone for
/// cylinders), and the optical depth, mu_t times the depth, at fixed depth.
struct GradientJob : PathJob {
  std::vector<std::string> parameters;
  Estimator gradient;  ///< [parameter][entry]
};

/// As results call it.
std::string name_of(BulkParameter parameter);

/// What a scene's paths are differentiated by; the optical depth follows from mu_t.
std::vector<BulkParameter> bulk_parameters(const Scene& scene);

/// Of a job whose quantities after the covariance are derivatives by the parameters, mu_t first.
GradientJob gradient_job(const PathJob& job, const std::vector<BulkParameter>& parameters,
                         const Scene& scene);

/// Throws InputError for a scene that does not scatter or a request of too many entries.
void check_gradient(const Scene& scene);

/// As make_plan(), but g = 0 of hg is free to change. Throws as check_gradient().
Plan gradient_plan(const Scene& scene, ReversedPaths reversed);

GradientJob gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed);

/// Derivatives of what memory_effect() gives: of C_E, [parameter][tilt], and of the range,
/// [parameter]: 0 where it is censored.
struct CorrelationGradient {
  Estimate correlation, range;
};
CorrelationGradient memory_effect_gradient(const CovarianceRequest& request,
                                           const GroupedSums& sums, const GradientJob& job);

/// Derivatives of all that a gradient's file has, [parameter] first; range of q L.
struct GradientEstimates {
  Estimate entries;
  CorrelationGradient effect;  ///< of a memory_effect request
};
GradientEstimates gradient_estimates(const Scene& scene, const GroupedSums& sums,
                                     const GradientJob& job);

extern const DatasetTable gradient_table;
/// The request's axes must have been written.
void write_gradient(ResultFile& file, const CovarianceRequest& request, const GradientJob& job,
                    const GradientEstimates& gradient);

}  // namespace flatspeckle::mc
