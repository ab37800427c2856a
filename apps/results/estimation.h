#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "core/result/result_file.h"
#include "core/session/run_settings.h"
#include "flatland/request/field_moments.h"
#include "flatland/scene/scene.h"
#include "mc/paths/walk/plan.h"

namespace flatspeckle::apps {

/// How each method is to be run on a scene.
struct MethodSettings {
  std::string reversed_paths = "auto";
  bool neglect_k_shift = false;
  double wave_tolerance = 1e-6;
  std::optional<std::int64_t> wave_samples;
  double tolerance = 1e-6;  ///< of transport

  double tolerance_of(const std::string& method) const {
    return method == "wave" ? wave_tolerance : tolerance;
  }
};

void add_mc_keys(Keys& keys, MethodSettings& settings);
void add_wave_keys(Keys& keys, MethodSettings& settings);
void add_transport_keys(Keys& keys, MethodSettings& settings);

/// Reads what Monte Carlo and transport heed.
mc::ReversedPaths reversed_paths(const Keys& keys, const MethodSettings& settings);

/// A method applied to a scene: what the runner needs, and in words what was planned. write: prints
/// and writes what it tells besides the covariance; empty where that is nothing.
struct Estimation {
  FieldJob job;
  std::string plan;
  std::function<void(ResultFile&, const GroupedSums&)> write = {};
};

/// Puts into `method` what auto stands for: of a slab transport, unless what only Monte Carlo heeds
/// is given.
void choose_method(const Keys& keys, std::string& method, const SceneSpec& spec,
                   const RunSettings& run);

/// What make_scene() reads and none of the methods makes use of counts as not read.
void disregard_unused(const Keys& keys, const SceneSpec& spec,
                      const std::vector<std::string>& methods);

/// Reads what transport heeds. Throws InputError for what is no slab.
void read_transport(const Keys& keys, MethodSettings& settings, const SceneSpec& spec,
                    const RunSettings& run);
/// Returns the stop rule of deterministic methods, whose jobs are two batches. A run whose error is
/// more than the tolerance has not converged.
StopRule both_batches(double tolerance);

/// Disks are placed in whole numbers: says so on standard error where that changes the density
/// (conventions, C12).
void note_rounding(const Scene& scene);

/// What the Monte Carlo method neglects grows with these; of several scenes: the worst.
struct Neglected {
  double k_mean_free_path = std::numeric_limits<double>::infinity();
  double packing = 0;      ///< of disks whose correlations are not taken in
  double k_shift = 0;      ///< over k: shift of the wavenumber (conventions, C15)
  double phase = 0;        ///< what that shift adds over the depth, radians
  bool refracted = false;  ///< what it does to the mean field is taken in

  Neglected() = default;
  explicit Neglected(const Scene& scene) { add(scene); }
  void add(const Scene& scene);

 private:
  void add(const BulkMedium& medium, double k);
};

/// Throws InputError where scatterers shift the wavenumber by so much that what neglects it is
/// absurd, unless the key neglect_k_shift says to go on.
void refuse_absurd(const MethodSettings& settings, const Neglected& neglected);
/// Says so on standard error where that is much.
void note(const Neglected& neglected);

/// The scene with the rounded number in place of its density, so that both solvers have the same.
Scene rounded_scene(const Scene& scene, const SceneSpec& spec);

/// The scene of the plane, or with `dimension` = 3 the one of space that has the same keys. Throws
/// InputError for what is no slab.
Scene with_dimension(const Scene& scene, const SceneSpec& spec);

Estimation mc_estimation(const Scene& scene, mc::ReversedPaths reversed, std::uint64_t seed);
/// Of a slab, of the plane or in space.
Estimation transport_estimation(const Scene& scene, mc::ReversedPaths reversed, double tolerance);
/// What exact solutions are planned to be.
std::string wave_plan(const Scene& scene, double tolerance);
/// Throws InputError.
Estimation wave_estimation(const Scene& scene, double tolerance, std::uint64_t seed);

}  // namespace flatspeckle::apps
