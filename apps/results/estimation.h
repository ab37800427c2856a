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

/// Settings of the methods Monte Carlo, transport and exact solutions (wave).
struct MethodSettings {
  std::string reversed_paths = "auto";
  bool neglect_k_shift = false;
  double wave_tolerance = 1e-6;
  std::optional<std::int64_t> wave_samples;
  double tolerance = 1e-6;  ///< tolerance of transport

  double tolerance_of(const std::string& method) const {
    return method == "wave" ? wave_tolerance : tolerance;
  }
};

void add_mc_keys(Keys& keys, MethodSettings& settings);
void add_wave_keys(Keys& keys, MethodSettings& settings);
void add_transport_keys(Keys& keys, MethodSettings& settings);

/// Returns the value of the key reversed_paths. Marks the keys reversed_paths and neglect_k_shift
/// as read; to be called if Monte Carlo or transport is used.
mc::ReversedPaths reversed_paths(const Keys& keys, const MethodSettings& settings);

/// A method applied to a scene: the job to be run, and a description of the method for the user.
/// write: function that prints and writes results besides the covariance; empty if there are none.
struct Estimation {
  FieldJob job;
  std::string plan;
  std::function<void(ResultFile&, const GroupedSums&)> write = {};
};

/// If method = auto, replaces it: by transport for a homogeneous slab if neither samples nor
/// seconds are given, and otherwise by mc.
void choose_method(const Keys& keys, std::string& method, const SceneSpec& spec,
                   const RunSettings& run);

/// Marks keys as not read that make_scene() has read but that none of these methods uses, so that
/// they are rejected if given.
void disregard_unused(const Keys& keys, const SceneSpec& spec,
                      const std::vector<std::string>& methods);

/// Reads the keys that transport uses. Throws InputError unless the domain is a slab.
void read_transport(const Keys& keys, MethodSettings& settings, const SceneSpec& spec,
                    const RunSettings& run);
/// Returns the stop rule of deterministic methods: both of the two batches of their jobs are run.
/// If the error of the result is above the tolerance, the run has not converged.
StopRule both_batches(double tolerance);

/// Prints a note on standard error if the number of disks is rounded to an integer, which changes
/// their density (C12).
void note_rounding(const Scene& scene);

/// Parameters that determine the size of the effects that Monte Carlo neglects. For several scenes,
/// each parameter has its worst value.
struct Neglected {
  double k_mean_free_path = std::numeric_limits<double>::infinity();
  double packing = 0;  ///< packing fraction of disks or spheres whose correlations are neglected
  int dimension = 2;
  double k_shift = 0;  ///< relative shift of the wavenumber by the scatterers (C15)
  /// Phase, in radians, that the shift of the wavenumber adds over the depth of the medium.
  double phase = 0;
  bool refracted = false;  ///< whether Monte Carlo includes the effect of k_shift on the mean field

  Neglected() = default;
  explicit Neglected(const Scene& scene) { add(scene); }
  void add(const Scene& scene);

 private:
  void add(const BulkMedium& medium, double k);
};

/// Throws InputError if the scatterers shift the wavenumber too much for methods that neglect this
/// shift, unless neglect_k_shift = true.
void refuse_absurd(const MethodSettings& settings, const Neglected& neglected);
/// Prints notes on standard error about neglected effects that are large.
void note(const Neglected& neglected);

/// Whether a scene in the plane probably stands for a sample of a laboratory, and could be in
/// space: a slab with a phase function, for which the keys give a unit of length, or delays.
bool is_flat_sample(const Keys& keys, const Scene& scene);
/// Whether a scene in the plane could be in space: a slab with a phase function and without layers.
bool could_be_in_space(const Scene& scene);
/// Prints a note on standard error that the scene is in the plane, and what differs in space.
void note_plane();

/// Returns the scene with the number of disks, rounded to an integer, instead of their density, so
/// that Monte Carlo and exact solutions use the same number.
Scene rounded_scene(const Scene& scene, const SceneSpec& spec);

/// Prints by which law the faces of a medium in space reflect. Prints nothing without faces.
void print_faces(const Scene& scene);

/// Prints by which law the faces of a medium in space reflect. Prints nothing without faces.
void print_faces(const Scene& scene);

/// Prints diameter, packing fraction, reduced scattering and transport mean free path, in the unit
/// of length of the scene. Prints nothing if the scatterers have no size or vary.
void print_suspension(const Scene& scene);

/// Returns `scene` if dimension = 2. If dimension = 3, returns the three-dimensional scene with the
/// same keys, which must be a slab (InputError).
Scene with_dimension(const Scene& scene, const SceneSpec& spec);

Estimation mc_estimation(const Scene& scene, mc::ReversedPaths reversed, std::uint64_t seed);
/// Returns the estimation of the covariance by transport through a slab, in two or three
/// dimensions.
Estimation transport_estimation(const Scene& scene, mc::ReversedPaths reversed, double tolerance);
/// Returns a description of the exact solutions (method wave) for this scene, for the user.
std::string wave_plan(const Scene& scene, double tolerance);
/// Returns the estimation of the covariance by exact solutions. Throws InputError.
Estimation wave_estimation(const Scene& scene, double tolerance, std::uint64_t seed);

}  // namespace flatspeckle::apps
