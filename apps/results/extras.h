#pragma once

#include <optional>
#include <vector>

#include "apps/results/estimation.h"
#include "mc/jobs/contrast.h"
#include "mc/jobs/path_job.h"

namespace flatspeckle::apps {

/// What methods tell of a scene besides its covariance.
struct Extras {
  bool gradient = false;
  std::vector<double> delays, frequency_shifts;
  std::vector<double> velocity;
  std::optional<double> diffusion, shear;
  mc::Exposure exposure;
};
void add_frequency_key(Keys& keys, std::vector<double>& shifts);
void add_extra_keys(Keys& keys, Extras& extras);

/// Reads the keys that a method heeds. Throws InputError for extras that exclude each other.
void read_extras(const Keys& keys, const Extras& extras, const std::string& method);

/// What estimates the covariance of fields, and that of changed ones (changed_fields.h).
struct ChangeEstimation {
  mc::PathJob job;
  std::string plan;
};
// Fields at shifted frequencies. Throw InputError.
ChangeEstimation mc_frequencies(const Scene& scene, mc::ReversedPaths reversed,
                                const std::vector<double>& shifts, std::uint64_t seed);
ChangeEstimation transport_frequencies(const Scene& scene, mc::ReversedPaths reversed,
                                       const std::vector<double>& shifts, double tolerance);
ChangeEstimation wave_frequencies(const Scene& scene, const std::vector<double>& shifts,
                                  double tolerance, std::uint64_t seed);

/// By Monte Carlo. Throws InputError for extras that the scene cannot have.
Estimation extended_estimation(const Scene& scene, mc::ReversedPaths reversed, const Extras& extras,
                               std::uint64_t seed);
/// The same of a slab by transport.
Estimation extended_transport(const Scene& scene, mc::ReversedPaths reversed, const Extras& extras,
                              double tolerance);
/// The same of a box by exact solutions.
Estimation extended_waves(const Scene& scene, const Extras& extras, double tolerance,
                          std::uint64_t seed);

}  // namespace flatspeckle::apps
