#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "core/result/dataset_row.h"
#include "core/result/result_file.h"
#include "flatland/scene/scene.h"
#include "mc/jobs/bulk_parameter.h"
#include "mc/jobs/path_job.h"

namespace flatspeckle::mc {

/// Returns the derivative of f(entries + t * along) with respect to t at t = 0, by a central
/// difference.
template <typename F>
std::vector<Complex> directional_derivative(const F& f, std::span<const Complex> entries,
                                            std::span<const Complex> along) {
  const auto largest = [](std::span<const Complex> values) {
    double most = 0;
    for (const Complex value : values) most = std::max(most, std::abs(value));
    return most;
  };
  const bool still = largest(along) == 0;
  const double step = still ? 1 : 1e-6 * largest(entries) / largest(along);
  const auto moved = [&](double by) {
    std::vector<Complex> values(entries.begin(), entries.end());
    for (std::size_t e = 0; e < values.size(); ++e) values[e] += by * along[e];
    return f(values);
  };
  std::vector<Complex> derivative = moved(step);
  const std::vector<Complex> below = moved(-step);
  for (std::size_t i = 0; i < derivative.size(); ++i)
    derivative[i] = (derivative[i] - below[i]) / (2 * step);
  return derivative;
}

/// Job for a covariance and its derivatives, from the same paths. Only the integrand of C14 is
/// differentiated, not the density from which paths are sampled. The parameters are mu_t, g and
/// albedo for scatterer = hg, mu_t and albedo for points and other bulk scatterers, mu_t, radius
/// and index for cylinders, and in all cases the optical depth, mu_t times the depth, at fixed
/// depth.
struct GradientJob : PathJob {
  std::vector<std::string> parameters;
  Estimator gradient;  ///< estimator of the derivatives, [parameter][entry]
};

/// Returns the parameters of a scene's derivatives, without the optical depth, which follows from
/// mu_t. Cylinders with a structure factor have only mu_t, because a change of their size would
/// change the structure factor.
std::vector<BulkParameter> bulk_parameters(const Scene& scene);

/// Adds the estimator of the derivatives to a job. The quantities of the job are the covariance,
/// then its derivatives with respect to `parameters`; the first parameter must be mu_t.
GradientJob gradient_job(const PathJob& job, const std::vector<BulkParameter>& parameters,
                         const Scene& scene);

/// Throws InputError if the scene does not scatter or its request has too many entries.
void check_gradient(const Scene& scene);

/// Derivatives of the results of memory_effect(): of the field correlation C_E, [parameter][tilt],
/// and of the range (half-width), [parameter]. The derivatives of a censored range are 0.
struct CorrelationGradient {
  Estimate correlation, range;
};

/// All derivatives that a result file contains, with the parameter as first index. effect.range
/// contains derivatives of q L, where L is the depth and q the half-width.
struct GradientEstimates {
  Estimate entries;
  CorrelationGradient effect;  ///< for memory_effect requests
};
GradientEstimates gradient_estimates(const Scene& scene, const GroupedSums& sums,
                                     const GradientJob& job);

extern const DatasetTable gradient_table;
/// Writes the derivatives. The axes of the request must have been written before.
void write_gradient(ResultFile& file, const CovarianceRequest& request, const GradientJob& job,
                    const GradientEstimates& gradient);

}  // namespace flatspeckle::mc
