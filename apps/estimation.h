#pragma once

#include <limits>
#include <optional>
#include <string>

#include "apps/run_options.h"
#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/walk/plan.h"

namespace flatspeckle::apps {

/// How each method is to be run on a scene.
struct MethodSettings {
  std::string reversed_paths = "auto";
  double wave_tolerance = 1e-6;
  std::optional<std::int64_t> wave_samples;
};

void add_mc_options(Options& options, MethodSettings& settings);
void add_wave_options(Options& options, MethodSettings& settings);

/// Throws InputError.
mc::ReversedPaths reversed_paths(const MethodSettings& settings);

/// A method applied to a scene: what the runner needs, and in words what was planned.
struct Estimation {
  FieldJob job;
  std::string plan;
};

/// Disks are placed in whole numbers: says so on standard error where that changes the density
/// (conventions, C12).
void note_rounding(const Scene& scene);

/// What the Monte Carlo method neglects grows with these; of several scenes: the worst.
struct Neglected {
  double k_mean_free_path = std::numeric_limits<double>::infinity();
  double packing = 0;  ///< of disks whose correlations are not taken in
  void add(const Scene& scene);
};

/// Says so on standard error where that is much.
void note(const Neglected& neglected);

/// Gives the rounded number instead, so that both solvers have the same density.
void round_density(SceneSpec& spec);

Estimation mc_estimation(const Scene& scene, const MethodSettings& settings, std::uint64_t seed);
Estimation wave_estimation(const Scene& scene, const MethodSettings& settings, std::uint64_t seed);

}  // namespace flatspeckle::apps
