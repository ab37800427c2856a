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

/// Henyey-Greenstein bulk; `request` replaces lights, views and entries.
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

/// What a run left behind: entries with errors, or any function of them.
struct Run {
  FieldJob job;
  GroupedSums sums;

  Estimate entries() const { return jackknife(sums, job.covariance); }
  /// sum of weight x Re(entry) over the entries, and its error.
  Estimate weighted_sum(const std::vector<double>& weights) const;
};

/// The sums of so many samples, on two threads.
GroupedSums summed(const BatchJob& job, std::uint64_t samples);

/// How many of these paths tests take: by day a quarter where there are more than 40,000 (Effort).
std::uint64_t shortened(std::uint64_t paths);

/// Deterministic: two threads or not. Takes `shortened` paths.
Run run(const Scene& scene, const Plan& plan, std::uint64_t paths, std::uint64_t seed);
/// By the plan of the scene. paths_per_batch = 0 keeps the plan's.
Run run(const Scene& scene, ReversedPaths reversed, std::uint64_t paths, std::uint64_t seed,
        std::uint64_t paths_per_batch = 0);

/// Within four standard errors, plus a bias that the caller can account for.
#define CHECK_WITHIN_4_SIGMA(found, error, expected, bias)                            \
  do {                                                                                \
    INFO("found ", flatspeckle::mc::tests::text(found), " +- ", error, ", expected ", \
         flatspeckle::mc::tests::text(expected));                                     \
    CHECK(std::abs((found) - (expected)) < 4 * (error) + (bias));                     \
  } while (false)

std::string text(Complex value);

}  // namespace flatspeckle::mc::tests
