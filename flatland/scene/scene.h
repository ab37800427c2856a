#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "flatland/media/domain.h"
#include "flatland/media/index_field.h"
#include "flatland/media/medium.h"
#include "flatland/media/medium_profile.h"
#include "flatland/placement/placement.h"
#include "flatland/request/request.h"
#include "flatland/scatterers/scatterer_kinds.h"

namespace flatspeckle {

/// Scene keys as the user gives them; names and meanings as in the README. Lengths in any one unit,
/// angles in radians.
struct SceneSpec : ScattererValues {
  std::int64_t dimension = 2;
  std::string domain = "box";
  std::optional<double> width, depth;
  std::optional<std::int64_t> count;
  std::optional<double> density, mean_free_path, optical_depth;
  std::optional<std::string> placement;
  std::optional<double> min_gap;
  std::string structure = "none";
  std::string layers, density_blobs, density_map;
  std::string index_field = "homogeneous", index_blobs, index_grid;
  double axis_index = 1;
  std::vector<double> index_slope{};
  std::optional<double> index_alpha, sound_amplitude, sound_wavenumber;
  std::vector<double> light_angles{0};
  std::string near_sources;
  std::optional<double> beam_waist, beam_depth;
  std::vector<double> beam_positions{};
  std::vector<double> view_angles{0};
  std::string near_sensors;
  std::vector<double> tilts{}, shifts{};
  std::string covariance = "intensity";
  std::vector<double> pairs{};
};

/// All that a solver is told: one scene, two eyes.
struct Scene {
  double wavelength = 1, k = 0;
  Domain domain;
  Scatterer scatterer;
  BulkMedium medium;                               ///< where it varies, in the mean
  std::shared_ptr<const MediumProfile> profile{};  ///< null where it is the same everywhere
  std::optional<IndexField> index{};               ///< none where it is 1 everywhere
  PlacementRule placement;
  CovarianceRequest request;
};

// Rows of the keys, by what they are of; add_keys adds all.
void add_scatterer_keys(Keys& keys, SceneSpec& spec);
/// g, albedo and optical_depth.
void add_bulk_keys(Keys& keys, SceneSpec& spec);
void add_medium_keys(Keys& keys, SceneSpec& spec);
/// Of methods that can be in space; not among those of add_keys.
void add_dimension_key(Keys& keys, SceneSpec& spec);
/// The structure factor that Monte Carlo takes positions to have.
void add_structure_key(Keys& keys, SceneSpec& spec);
/// Of media that vary.
void add_profile_keys(Keys& keys, SceneSpec& spec);
/// Of an index that varies.
void add_index_keys(Keys& keys, SceneSpec& spec);
void add_view_keys(Keys& keys, SceneSpec& spec);
/// Near sources and beams.
void add_light_keys(Keys& keys, SceneSpec& spec);
/// Which entries of the covariance.
void add_request_keys(Keys& keys, SceneSpec& spec);
void add_keys(Keys& keys, SceneSpec& spec);

// What follows reads a spec by its keys and throws InputError naming key, value and what is
// accepted.

/// Lights, views and entries alone.
CovarianceRequest make_request(const Keys& keys, const SceneSpec& spec);
/// Everything; the last to read the keys: it refuses what is given and was not read, before the
/// work of deriving the bulk.
Scene make_scene(const Keys& keys, const SceneSpec& spec);
/// The same of values alone, all of which must be of use.
Scene make_scene(const SceneSpec& spec);
CovarianceRequest make_request(const SceneSpec& spec);

/// The infinite slab has lights from below the horizon, and (C18) of plane waves and far views only
/// entries whose transverse momenta match; near ends, which transport alone takes, on one side of
/// the light's way. Throws InputError.
void check_slab_request(const CovarianceRequest& request, double depth);

/// Throws InputError, which names the key, for a near source or sensor at a distance r from the
/// origin at which double precision does not hold the phase k r: k r eps must be at most 0.001.
void require_phase(const std::string& key, Vec2 point, double k);
/// Throws InputError in that case, and where places of the medium are lost in the rounding of r.
void require_reach(const std::string& key, Vec2 point, const Scene& scene);

/// What a scene took from other files, exactly: near sensors and sources, and the structure factor.
std::string inputs_text(const Scene& scene);

/// Draws a realization of a scene in a box.
Placement draw_placement(const Scene& scene, RandomStream& random);

/// That which the key index_field names; none where the index is the same everywhere. Reads its
/// keys and the file of blobs. Throws InputError.
std::optional<IndexField> index_field(const Keys& keys, const SceneSpec& spec);

/// Throws InputError where a scene cannot have the field that it has: what scatters, the domain,
/// and n^2 wherever light goes.
void check_index_field(const Scene& scene);

/// Throws InputError where the index varies, which `what` does not take.
void refuse_graded(const Scene& scene, const std::string& what);

}  // namespace flatspeckle
