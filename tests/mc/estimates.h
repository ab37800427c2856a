#pragma once

#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include "flatland/scene/scene.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::tests {

inline constexpr double pi = std::numbers::pi;
using flatspeckle::tests::effort;
using flatspeckle::tests::is_night;

/// Henyey-Greenstein bulk medium. `request` below replaces lights, views and entries.
struct HgBulk {
  double mean_free_path = 1, g = 0, albedo = 1;
};
Scene hg_box(double width, double depth, const HgBulk& bulk, const CovarianceRequest& request,
             double wavelength = 1);
Scene hg_slab(double depth, const HgBulk& bulk, const CovarianceRequest& request,
              double wavelength = 1);

/// Henyey-Greenstein layers of a slab, from z = 0 on.
struct Layer {
  double thickness, optical_depth, g, albedo;
};
Scene layered(const std::vector<Layer>& layers, const CovarianceRequest& request);

std::vector<View> far_views(const std::vector<double>& angles);

/// Result of a run: entries with errors, or any function of them.
struct Run {
  FieldJob job;
  GroupedSums sums;

  Estimate entries() const { return jackknife(sums, job.covariance); }
  /// Returns the sum of weight x Re(entry) over the entries, and its error.
  Estimate weighted_sum(const std::vector<double>& weights) const;
};

/// Runs `samples` samples on two threads and returns their sums.
GroupedSums summed(const BatchJob& job, std::uint64_t samples);

/// Returns the number of paths that a test runs: by day fewer of more than 40,000 (Effort).
std::uint64_t shortened(std::uint64_t paths);

/// Runs `shortened(paths)` paths; results do not depend on the number of threads.
Run run(const Scene& scene, const Plan& plan, std::uint64_t paths, std::uint64_t seed);
/// Runs the scene's default plan; paths_per_batch = 0 keeps the plan's value.
Run run(const Scene& scene, ReversedPaths reversed, std::uint64_t paths, std::uint64_t seed,
        std::uint64_t paths_per_batch = 0);

/// Checks agreement within four standard errors plus a bias that the caller can account for.
#define CHECK_WITHIN_4_SIGMA(found, error, expected, bias)                               \
  do {                                                                                   \
    INFO("estimate ", flatspeckle::mc::tests::text(found), " +- ", error, ", expected ", \
         flatspeckle::mc::tests::text(expected));                                        \
    CHECK(std::abs((found) - (expected)) < 4 * (error) + (bias));                        \
  } while (false)

std::string text(Complex value);

}  // namespace flatspeckle::mc::tests
