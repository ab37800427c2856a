#pragma once

#include <functional>
#include <vector>

#include "apps/command_line.h"
#include "apps/estimation.h"
#include "core/result/result_file.h"

namespace flatspeckle::apps {

/// What Monte Carlo tells of a scene besides its covariance, from the same paths.
struct Extras {
  bool gradient = false;
  std::vector<double> delays;
};
void add_extra_options(Options& options, Extras& extras);

/// An estimation and how its extra results are printed and written; write is empty without extras.
struct ExtendedEstimation {
  Estimation estimation;
  std::function<void(ResultFile&, const GroupedSums&)> write;
};

/// Throws InputError for extras that exclude each other, or that the scene cannot have.
ExtendedEstimation extended_estimation(const Scene& scene, const MethodSettings& settings,
                                       const Extras& extras, std::uint64_t seed);
/// Throws InputError where there are any: other methods have none.
void refuse_extras(const Extras& extras);

}  // namespace flatspeckle::apps
