#include "apps/estimation.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>

#include "core/error.h"
#include "mc/estimators/covariance_estimator.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::apps {

mc::ReversedPaths reversed_paths(const MethodSettings& settings) {
  const std::string& word = settings.reversed_paths;
  if (word == "auto") return mc::ReversedPaths::automatic;
  if (word == "yes") return mc::ReversedPaths::yes;
  if (word == "no") return mc::ReversedPaths::no;
  throw InputError("reversed_paths", word, "must be one of auto yes no");
}

void add_mc_options(Options& options, MethodSettings& settings) {
  options.add_with_default(
      "--reversed_paths", settings.reversed_paths,
      "Coherent backscattering in Monte Carlo: auto (where a view may see it), yes, no");
}

void add_wave_options(Options& options, MethodSettings& settings) {
  options.add_with_default("--wave_tolerance", settings.wave_tolerance,
                           "Accuracy of each exact solution, relative");
  options.add("--wave_samples", settings.wave_samples,
              "Placements of the exact solver, where samples counts light paths");
}

void note_rounding(const Scene& scene) {
  const double mean = scene.placement.mean_count, placed = std::round(mean);
  if (scene.placement.kind == PlacementRule::Kind::poisson || std::abs(placed - mean) < 1e-9)
    return;
  std::cerr << "note: hard disks are placed in whole numbers: " << placed << " in each placement, "
            << mean << " asked for\n";
}

void Neglected::add(const Scene& scene) {
  const BulkMedium& medium = scene.medium;
  k_mean_free_path = std::min(k_mean_free_path, scene.k * medium.mean_free_path());
  if (medium.structure.independent()) packing = std::max(packing, medium.packing_fraction);
}

void note(const Neglected& neglected) {
  constexpr double small = 10, dense = 0.02;
  if (neglected.k_mean_free_path < small)
    std::cerr << "note: k x mean free path is only " << neglected.k_mean_free_path
              << "; the Monte Carlo method neglects terms of order 1 over that\n";
  if (neglected.packing > dense)
    std::cerr
        << "note: disks fill " << neglected.packing
        << " of the medium; the Monte Carlo method takes their positions as independent, which "
           "neglects terms of that order (structure = hard_disks takes them in)\n";
}

void round_density(SceneSpec& spec) {
  const Scene scene = make_scene(spec);
  if (scene.placement.kind == PlacementRule::Kind::poisson || spec.count) return;
  spec.density = spec.mean_free_path = spec.optical_depth = std::nullopt;
  spec.count = std::llround(scene.placement.mean_count);
}

Estimation mc_estimation(const Scene& scene, const MethodSettings& settings, std::uint64_t seed) {
  const auto plan = mc::make_plan(scene, reversed_paths(settings));
  const auto& structure = scene.medium.structure;
  return {mc::covariance_job(scene, plan, seed),
          "mc: " + plan.describe() +
              (structure.independent() ? "" : "; structure factor " + structure.origin())};
}

Estimation wave_estimation(const Scene& scene, const MethodSettings& settings, std::uint64_t seed) {
  if (!(settings.wave_tolerance > 0 && settings.wave_tolerance < 1))
    throw InputError("wave_tolerance", settings.wave_tolerance, "must be in (0, 1)");
  std::ostringstream plan;
  plan << "wave: dense T-matrix solutions of " << placement_word(scene.placement.kind)
       << " placements, tolerance " << settings.wave_tolerance << "; sample mean removed";
  return {wave::wave_job(scene, seed, settings.wave_tolerance), plan.str()};
}

}  // namespace flatspeckle::apps
