#pragma once

#include "bench/scenes/standard_scenes.h"
#include "flatland/scene/scene.h"
#include "mc/paths/estimators/covariance_estimator.h"

namespace flatspeckle::bench {

inline constexpr double mc_depth = 10;

/// Parameters of a Henyey-Greenstein slab, by default ten wavelengths deep.
struct Bulk {
  double optical_depth, g = 0, albedo = 1, depth = mc_depth;
};
Scene hg_slab(const Bulk& bulk, const CovarianceRequest& request);
/// Returns a box filled with this medium.
Scene hg_box(double width, const Bulk& bulk, const CovarianceRequest& request);

/// Runs `samples` samples of a job on this thread and returns their sums.
GroupedSums summed(const BatchJob& job, std::uint64_t samples);

/// Returns the sum of the magnitudes of all values and errors.
double total_magnitude(const Estimate& found);

/// Estimates the covariance of a scene and its standard errors, with the scene's plan.
Estimate covariance(const Scene& scene, mc::ReversedPaths reversed, std::uint64_t paths,
                    std::uint64_t seed = 1);

}  // namespace flatspeckle::bench
