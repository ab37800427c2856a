#pragma once

#include <optional>
#include <vector>

#include "apps/results/estimation.h"
#include "mc/jobs/contrast.h"
#include "mc/jobs/path_job.h"

namespace flatspeckle::apps {

/// Optional results besides the covariance: derivatives (gradient), and correlations over delays,
/// frequency shifts and motion.
struct Extras {
  bool gradient = false;
  std::vector<double> delays, frequency_shifts;
  std::vector<double> velocity;
  std::optional<double> diffusion, shear;
  mc::Exposure exposure;
};
void add_frequency_key(Keys& keys, std::vector<double>& shifts);
void add_extra_keys(Keys& keys, Extras& extras);

/// Marks the keys of the optional results that the method can compute as read. Throws InputError
/// for optional results that exclude each other.
void read_extras(const Keys& keys, const Extras& extras, const std::string& method);

/// Estimation of the covariance of fields, and of their correlation with the fields after changes
/// such as frequency shifts (changed_fields.h).
struct ChangeEstimation {
  mc::PathJob job;
  std::string plan;
};
// Make the estimation for fields at these frequency shifts, by each method. Throw InputError.
ChangeEstimation mc_frequencies(const Scene& scene, mc::ReversedPaths reversed,
                                const std::vector<double>& shifts, std::uint64_t seed);
ChangeEstimation transport_frequencies(const Scene& scene, mc::ReversedPaths reversed,
                                       const std::vector<double>& shifts, double tolerance);
ChangeEstimation wave_frequencies(const Scene& scene, const std::vector<double>& shifts,
                                  double tolerance, std::uint64_t seed);

/// Returns the estimation of the covariance and the optional results by Monte Carlo. Throws
/// InputError for optional results that are not possible for this scene.
Estimation extended_estimation(const Scene& scene, mc::ReversedPaths reversed, const Extras& extras,
                               std::uint64_t seed);
/// Returns the estimation of the covariance and the optional results by transport through a slab.
Estimation extended_transport(const Scene& scene, mc::ReversedPaths reversed, const Extras& extras,
                              double tolerance);
/// Returns the estimation of the covariance and the optional results by exact solutions for a box.
Estimation extended_waves(const Scene& scene, const Extras& extras, double tolerance,
                          std::uint64_t seed);

}  // namespace flatspeckle::apps
