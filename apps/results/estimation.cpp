#include "apps/results/estimation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <sstream>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/numbers/blas.h"
#include "flatland/scene/scene_density.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/slab_jobs.h"
#include "wave_solver/solutions/ensemble.h"

namespace flatspeckle::apps {

mc::ReversedPaths reversed_paths(const Keys& keys, const MethodSettings& settings) {
  keys.read(settings.neglect_k_shift);
  const std::string& word = keys.read(settings.reversed_paths);
  return word == "yes"  ? mc::ReversedPaths::yes
         : word == "no" ? mc::ReversedPaths::no
                        : mc::ReversedPaths::automatic;
}

void add_mc_keys(Keys& keys, MethodSettings& settings) {
  keys.group("Methods");
  keys.add("reversed_paths", settings.reversed_paths,
           "Include reversed paths, which cause coherent backscattering; auto: if a view can "
           "detect this effect")
      .one_of({"auto", "yes", "no"});
  keys.add("neglect_k_shift", settings.neglect_k_shift,
           "Run Monte Carlo or transport, which neglect the shift of the wavenumber by the "
           "scatterers, even if the shift exceeds 1/5 of the wavenumber");
}

void add_wave_keys(Keys& keys, MethodSettings& settings) {
  keys.group("Methods");
  keys.add("wave_tolerance", settings.wave_tolerance, "Relative accuracy of each exact solution")
      .between(0, 1)
      .only_of("the exact solver");
  keys.add("wave_samples", settings.wave_samples,
           "Number of placements for the exact solver, if samples is given as the number of light "
           "paths")
      .positive()
      .effort()
      .only_of("the exact solver");
}

constexpr double least_tolerance = 1e-13;  // smallest accepted tolerance

void add_transport_keys(Keys& keys, MethodSettings& settings) {
  keys.group("Methods");
  keys.add("tolerance", settings.tolerance,
           "Tolerance of transport: relative difference from a solution with fewer ordinates")
      .from(least_tolerance, 0.5)
      .only_of("method = transport");
}

/// Whether a table that can be read has this column.
bool has_column(const std::string& path, const std::string& name) try {
  return read_csv(path).has(name);
} catch (const InputError&) {
  return false;  // make_scene() reports what is wrong with the table
}

void choose_method(const Keys& keys, std::string& method, const SceneSpec& spec,
                   const RunSettings& run) {
  if (keys.read(method) != "auto") return;
  const bool to_last = keys.given(run.samples) || keys.given(run.seconds);
  const bool by_mc = !spec.layers.empty() && spec.dimension == 2 && !spec.medium_index &&
                     !has_column(spec.layers, "medium_index"),
             varies = by_mc || spec.index_field != "homogeneous";
  method = spec.domain == "slab" && !varies && !to_last ? "transport" : "mc";
}

void disregard_unused(const Keys& keys, const SceneSpec& spec,
                      const std::vector<std::string>& methods) {
  const auto waves = std::ranges::count(methods, "wave");
  if (waves == 0) keys.disregard(spec.placement);
  if (waves == 0 && spec.structure == "none") keys.disregard(spec.min_gap);
  if (waves == std::ssize(methods)) keys.disregard(spec.structure);
}

void read_transport(const Keys& keys, MethodSettings& settings, const SceneSpec& spec,
                    const RunSettings& run) {
  if (spec.domain != "slab")
    throw InputError("method", "transport", "requires domain = slab; use another method");
  if (spec.index_field != "homogeneous")
    throw InputError("index_field", spec.index_field, "requires method = mc or wave");
  const double asked = keys.read(run.target_error).value_or(1);
  settings.tolerance = std::min(keys.read(settings.tolerance), std::max(asked, least_tolerance));
}

StopRule both_batches(double tolerance) {
  return {.samples = 2, .seconds = {}, .target_error = tolerance};
}

void note_rounding(const Scene& scene) {
  const double mean = scene.placement.mean_count, placed = std::round(mean);
  if (scene.placement.kind == PlacementRule::Kind::poisson || std::abs(placed - mean) < 1e-9)
    return;
  std::cerr << "note: hard disks are placed in whole numbers: " << placed << " per placement, "
            << mean << " requested\n";
}

void Neglected::add(const Scene& scene) {
  refracted = scene.index && !scene.index->is_around();
  phase = std::max(phase, std::abs(scene.medium.k_shift) * scene.domain.depth);
  dimension = scene.medium.dimension;
  if (!scene.profile) return add(scene.medium, scene.k);
  for (const Material& material : scene.profile->materials()) add(material.medium, scene.k);
}

void Neglected::add(const BulkMedium& medium, double k) {
  k_mean_free_path = std::min(k_mean_free_path, k * medium.mean_free_path());
  if (medium.structure.independent()) packing = std::max(packing, medium.packing_fraction);
  k_shift = std::max(k_shift, std::abs(medium.k_shift) / k);
}

void refuse_absurd(const MethodSettings& settings, const Neglected& neglected) {
  constexpr double absurd = 0.2;
  if (settings.neglect_k_shift || !(neglected.k_shift > absurd)) return;
  std::ostringstream text;
  text << "neglect_k_shift = false: the scatterers shift the wavenumber by " << neglected.k_shift
       << " (relative), which Monte Carlo and transport neglect; use fewer or weaker scatterers, "
          "method = wave in a box, or neglect_k_shift = true";
  throw InputError(text.str());
}

void note(const Neglected& neglected) {
  constexpr double small = 10, dense = 0.02, much_shift = 0.01;
  if (neglected.k_mean_free_path < small)
    std::cerr << "note: k x mean free path is only " << neglected.k_mean_free_path
              << "; Monte Carlo neglects terms of order 1/(k x mean free path)\n";
  if (neglected.packing > dense)
    std::cerr << "note: " << (neglected.dimension == 3 ? "spheres" : "disks") << " fill "
              << neglected.packing
              << " of the medium; independent positions are assumed, which neglects terms of that "
                 "order (structure = "
              << (neglected.dimension == 3 ? "hard_spheres" : "hard_disks") << " includes them)\n";
  if (neglected.k_shift > much_shift && !neglected.refracted)
    std::cerr
        << "note: the scatterers shift the wavenumber by " << neglected.k_shift << " (relative), "
        << neglected.phase
        << " rad over the depth, which Monte Carlo neglects (refraction at the edges; guiding of "
           "the mean field in a box narrower than deep; index_field = mean_field includes both)\n";
}

bool could_be_in_space(const Scene& scene) {
  return scene.medium.dimension == 2 && scene.domain.kind == Domain::Kind::slab &&
         scene.scatterer.is_bulk() && !scene.profile && !scene.index &&
         !has_near_endpoints(scene.request);
}

bool is_flat_sample(const Keys& keys, const Scene& scene) {
  const auto given = [&](const char* name) {
    const Key* const key = keys.find(name);
    return key != nullptr && key->given();
  };
  return (given("length_unit") || given("delays")) && could_be_in_space(scene);
}

void note_plane() {
  std::cerr << "note: the scene is in the plane (2D): its intensities, ranges and decay rates are "
               "not those of a sample in space, for which give dimension = 3\n";
}

Scene rounded_scene(const Scene& scene, const SceneSpec& spec) {
  if (scene.placement.kind == PlacementRule::Kind::poisson || spec.count || scene.profile)
    return scene;
  SceneSpec rounded = spec;
  remove_densities(rounded);
  rounded.count = std::llround(scene.placement.mean_count);
  return make_scene(rounded);
}

void print_faces(const Scene& scene) {
  if (!scene.faces || scene.medium.dimension != 3) return;
  std::puts(scene.faces->polarisation == Polarisation::unpolarised
                ? "faces: reflect the mean of both polarisations (polarisation = unpolarised)"
                : "faces: reflect as for scalar waves (polarisation = tm); flux and reflectance "
                  "accept unpolarised");
}

void print_suspension(const Scene& scene) {
  const BulkMedium& medium = scene.medium;
  if (scene.profile || !(medium.packing_fraction > 0)) return;
  std::printf("suspension: diameter %.6g, %s fraction %.5g, mu_s' %.5g, l* %.5g\n",
              2 * scene.scatterer.radius, medium.dimension == 3 ? "volume" : "area",
              medium.packing_fraction, medium.reduced_scattering(),
              medium.transport_mean_free_path());
}

Scene with_dimension(const Scene& scene, const SceneSpec& spec) {
  return spec.dimension == 3 ? mc::in_space(scene, spec) : scene;
}

Estimation mc_estimation(const Scene& scene, mc::ReversedPaths reversed, std::uint64_t seed) {
  const auto plan = mc::make_plan(scene, reversed);
  const auto& structure = scene.medium.structure;
  return {mc::covariance_job(scene, plan, seed),
          "mc: " + plan.describe() +
              (structure.independent() ? "" : "; structure factor " + structure.origin())};
}

Estimation transport_estimation(const Scene& scene, mc::ReversedPaths reversed, double tolerance) {
  const bool with_reversed = mc::make_plan(scene, reversed).reversed;
  blas_single_thread();  // called here so that missing memory is reported before the slow work
  std::ostringstream plan;
  const bool space = scene.medium.dimension == 3, near = has_near_endpoints(scene.request);
  if (space && near) throw InputError("dimension", 3, "requires plane waves and far views");
  plan << "transport: pairs at one transverse frequency" << (space ? " in space" : " in the plane")
       << (scene.profile ? " through layers" : "") << ", by doubling; "
       << (near ? "near endpoints as plane waves; " : "")
       << (with_reversed ? "reversed paths" : "no reversed paths") << "; tolerance " << tolerance;
  return {mc::slab_covariance_job(scene, with_reversed, {tolerance}), plan.str()};
}

std::string wave_plan(const Scene& scene, double tolerance) {
  std::ostringstream plan;
  const char* method = scene.faces ? "Foldy-Lax solutions with the Green function of the layer"
                       : scene.medium.dimension == 3 ? "T-matrix solutions in space"
                                                     : "dense T-matrix solutions";
  plan << "wave: " << method << " of " << placement_word(scene.placement.kind)
       << " placements, tolerance " << tolerance << "; sample mean removed";
  return plan.str();
}

Estimation wave_estimation(const Scene& scene, double tolerance, std::uint64_t seed) {
  return {wave::wave_job(scene, seed, tolerance), wave_plan(scene, tolerance)};
}

}  // namespace flatspeckle::apps
