#pragma once

#include <functional>
#include <vector>

#include "apps/results/estimation.h"
#include "core/result/result_file.h"

namespace flatspeckle::apps {

/// What Monte Carlo and transport tell of a scene besides its covariance.
struct Extras {
  bool gradient = false;
  std::vector<double> delays, frequency_shifts;
};
void add_extra_keys(Keys& keys, Extras& extras);

/// An estimation and how its extra results are printed and written; write is empty without extras.
struct ExtendedEstimation {
  Estimation estimation;
  std::function<void(ResultFile&, const GroupedSums&)> write;
};

/// Reads the keys, those of transport alone too if asked for. Throws InputError for extras that
/// exclude each other.
void read_extras(const Keys& keys, const Extras& extras, bool of_transport);

/// By Monte Carlo. Throws InputError for extras that the scene cannot have.
ExtendedEstimation extended_estimation(const Scene& scene, mc::ReversedPaths reversed,
                                       const Extras& extras, std::uint64_t seed);
/// The same of a slab by transport.
ExtendedEstimation extended_transport(const Scene& scene, mc::ReversedPaths reversed,
                                      const Extras& extras, double tolerance);

}  // namespace flatspeckle::apps
