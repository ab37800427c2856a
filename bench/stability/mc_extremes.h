#pragma once

#include "bench/scenes/standard_scenes.h"
#include "flatland/scene/scene.h"
#include "mc/paths/estimators/covariance_estimator.h"

namespace flatspeckle::bench {

inline constexpr double mc_depth = 10;

/// A Henyey-Greenstein slab of a depth of ten wavelengths, or of another.
struct Bulk {
  double optical_depth, g = 0, albedo = 1, depth = mc_depth;
};
Scene hg_slab(const Bulk& bulk, const CovarianceRequest& request);
/// The same bulk in a box.
Scene hg_box(double width, const Bulk& bulk, const CovarianceRequest& request);

/// On this thread.
GroupedSums summed(const BatchJob& job, std::uint64_t samples);

/// Of values and errors.
double total_magnitude(const Estimate& found);

/// A covariance by its plan, with errors.
Estimate covariance(const Scene& scene, mc::ReversedPaths reversed, std::uint64_t paths,
                    std::uint64_t seed = 1);

}  // namespace flatspeckle::bench
