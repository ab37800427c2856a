#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/results/estimation.h"
#include "mc/jobs/delay_results.h"
#include "mc/jobs/frequency_results.h"
#include "mc/jobs/path_job.h"

namespace flatspeckle::apps {

/// Optional results besides the covariance: derivatives (gradient), and correlations over delays
/// and frequency shifts.
struct Extras {
  bool gradient = false;
  mc::DynamicsValues moving;
  std::vector<std::string> frequency_shifts;
  mc::LineValues source;
  std::optional<double> length_unit;
  // The following members are set by read_extras().
  mc::Dynamics dynamics;
  mc::FrequencyShifts shifts;
  std::vector<mc::SourceLine> lines;

  /// Returns the values that depend on the unit of length, for the identity of a run.
  std::string identity() const;
};
void add_frequency_key(Keys& keys, std::vector<std::string>& shifts);
void add_extra_keys(Keys& keys, Extras& extras);

/// Reads the keys of the optional results that the method can compute. Throws InputError for
/// optional results that exclude each other.
void read_extras(const Keys& keys, Extras& extras, const SceneSpec& spec,
                 const std::string& method);
/// Returns the scene's unit of length in metres; nullopt if it is not given.
std::optional<double> length_unit(const Keys& keys);
/// Returns the frequency shifts that the key gives. Reads the key.
mc::FrequencyShifts frequency_shifts(const Keys& keys, const std::vector<std::string>& texts,
                                     const SceneSpec& spec);

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
