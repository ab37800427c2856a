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

/// Derivative of what f makes of entries, along that of the entries, by a central difference.
template <typename F>
std::vector<Complex> directional_slope(const F& f, std::span<const Complex> entries,
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
  std::vector<Complex> slope = moved(step);
  const std::vector<Complex> below = moved(-step);
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - below[i]) / (2 * step);
  return slope;
}

/// Derivatives of a scene's covariance from the paths that estimate it: the integrand of C14 is
/// differentiated, the density that the paths are drawn from is not. The parameters are mu_t, g and
/// albedo where they describe the scatterers as a bulk (all for hg, no g for points), of cylinders
/// mu_t, radius and index, and the optical depth, mu_t times the depth, at fixed depth.
struct GradientJob : PathJob {
  std::vector<std::string> parameters;
  Estimator gradient;  ///< [parameter][entry]
};

/// What a scene's paths are differentiated by; the optical depth follows from mu_t. Of cylinders
/// with a structure factor, which their size would change, mu_t alone.
std::vector<BulkParameter> bulk_parameters(const Scene& scene);

/// Of a job whose quantities after the covariance are derivatives by the parameters, mu_t first.
GradientJob gradient_job(const PathJob& job, const std::vector<BulkParameter>& parameters,
                         const Scene& scene);

/// Throws InputError for a scene that does not scatter or a request of too many entries.
void check_gradient(const Scene& scene);

/// Derivatives of what memory_effect() gives: of C_E, [parameter][tilt], and of the range,
/// [parameter]: 0 where it is censored.
struct CorrelationGradient {
  Estimate correlation, range;
};

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
