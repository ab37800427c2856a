#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "flatland/media/domain.h"
#include "flatland/media/faces.h"
#include "flatland/media/index_field.h"
#include "flatland/media/medium.h"
#include "flatland/media/medium_profile.h"
#include "flatland/placement/placement.h"
#include "flatland/request/request.h"
#include "flatland/scatterers/scatterer_kinds.h"

namespace flatspeckle {

/// Values of the scene keys as given by the user (docs/keys.md). All lengths are in the same,
/// arbitrary unit; angles are in radians.
struct SceneSpec : ScattererValues {
  std::int64_t dimension = 2;
  std::string domain = "box";
  std::optional<double> width, depth, height;
  std::optional<std::int64_t> count;
  std::optional<double> density, mean_free_path, optical_depth, volume_fraction, mass_fraction;
  /// Mass per volume of the scatterers and of the medium around them, in any one unit.
  std::optional<double> particle_density, medium_density;
  std::optional<std::string> placement;
  std::optional<double> min_gap;
  std::string structure = "none";
  std::string layers, density_blobs, density_map;
  std::string index_field = "homogeneous", index_blobs, index_grid;
  double axis_index = 1;
  std::vector<double> index_gradient{};
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
  /// Azimuths in space: one for each of the angles, or one for all; those of pairs as `pairs`.
  std::vector<double> light_azimuths{}, view_azimuths{}, pair_azimuths{};
  std::optional<double> tilt_azimuth;  ///< measured from the azimuth of the light
  std::optional<double> beam_y, camera_aperture;
  std::optional<std::int64_t> camera_pixels;
  std::optional<double> outside_index;
  std::optional<std::string> polarisation;

  /// Returns the wavelength around the scatterers and the wavelength outside the faces. If
  /// medium_index is given, `wavelength` is that in vacuum; otherwise all three are the same.
  double inside_wavelength() const { return wavelength / medium_index.value_or(1); }
  double outside_wavelength() const { return wavelength / outside_index.value_or(1); }
};

/// Accepted values of the scene key `polarisation`, in the order of Polarisation.
inline const std::vector<std::string> polarisation_words = {"tm", "te", "unpolarised"};

/// Complete input of a solver. The exact solver and Monte Carlo use the same scene.
struct Scene {
  double wavelength = 1, k = 0;  ///< around the scatterers
  Domain domain;
  /// Set if the refractive index of the medium is given. The angles and transverse wavenumbers of
  /// the request are then those outside the faces.
  std::optional<Faces> faces{};
  Scatterer scatterer;
  BulkMedium medium;                               ///< bulk properties; means if the medium varies
  std::shared_ptr<const MediumProfile> profile{};  ///< null if the medium is uniform
  std::optional<IndexField> index{};               ///< index around scatterers; nullopt if it is 1
  PlacementRule placement;
  CovarianceRequest request;

  /// Returns the wavenumber outside the faces.
  double outside_k() const { return faces ? k * (faces->outside / faces->inside) : k; }
};

// These functions add the schema entries of the scene keys, by topic. add_keys() calls all of them.
void add_scatterer_keys(Keys& keys, SceneSpec& spec);
/// Adds the keys g, albedo, mu_s, mu_a and optical_depth, and the keys of other phase functions.
void add_bulk_keys(Keys& keys, SceneSpec& spec);
void add_medium_keys(Keys& keys, SceneSpec& spec);
/// Adds the keys of scenes in space, for methods that also work in three dimensions.
void add_space_keys(Keys& keys, SceneSpec& spec);
/// Adds the keys of reflecting faces, for methods that include them.
void add_faces_keys(Keys& keys, SceneSpec& spec);
/// Adds the key structure, the structure factor of the scatterers' positions in Monte Carlo.
void add_structure_key(Keys& keys, SceneSpec& spec);
/// Adds the keys of layers and density maps.
void add_profile_keys(Keys& keys, SceneSpec& spec);
/// Adds the keys of the refractive index around the scatterers, if it varies in space.
void add_index_keys(Keys& keys, SceneSpec& spec);
void add_view_keys(Keys& keys, SceneSpec& spec);
/// Adds the keys of near sources and beams.
void add_light_keys(Keys& keys, SceneSpec& spec);
/// Adds the keys that select entries of the covariance.
void add_request_keys(Keys& keys, SceneSpec& spec);
void add_keys(Keys& keys, SceneSpec& spec);

// The functions below read the values of a spec through its keys. They throw InputError, which
// names the key, its value and what is accepted.

/// Creates only the request: lights, views and entries.
CovarianceRequest make_request(const Keys& keys, const SceneSpec& spec);
/// Creates the scene. Must be called after all other functions that read keys, because it rejects
/// keys that are given but have not been read.
Scene make_scene(const Keys& keys, const SceneSpec& spec);
/// Creates the scene from values alone. Throws InputError if a given value is not used.
Scene make_scene(const SceneSpec& spec);
CovarianceRequest make_request(const SceneSpec& spec);

/// Throws InputError if a request is not possible on an infinite slab. Light must enter the slab at
/// z = 0. For plane waves and far views, the two fields of an entry must have equal shifts of
/// transverse momentum (C18). Either the lights or the views may be near endpoints, but not both.
/// Only the transport solver supports near endpoints.
void check_slab_request(const CovarianceRequest& request, double depth);

/// Throws InputError, which names the key, if a near source or sensor is too far from the origin.
/// In double precision the phase k r, with r the distance, has the rounding error k r eps, which
/// must be at most 0.001 rad.
void require_phase(const std::string& key, Vec point, double k);
/// Throws InputError under the conditions of require_phase(), and if the distance r is so large
/// that its rounding error exceeds the differences between points of the medium.
void require_reach(const std::string& key, Vec point, const Scene& scene);

/// Returns, in full precision, all numbers that a scene read from other files: near sensors and
/// sources, structure factor and phase function.
std::string inputs_text(const Scene& scene);

/// Draws a realization of a scene in a box.
Placement draw_placement(const Scene& scene, RandomStream& random);

/// Returns the index field that the key index_field names; nullopt if the index is uniform. Reads
/// the keys of that field and the file of blobs. Throws InputError.
std::optional<IndexField> index_field(const Keys& keys, const SceneSpec& spec);

/// Throws InputError if the index field cannot be combined with the scatterers, lights or domain of
/// the scene, or if n^2 is not positive at a point that light must reach.
void check_index_field(const Scene& scene);

/// Returns the faces if the refractive index of the medium is given, otherwise nullopt.
/// first_layer: index of the first layer, if the file of layers contains it.
std::optional<Faces> make_faces(const Keys& keys, const SceneSpec& spec,
                                const std::optional<double>& first_layer = {});
/// Throws InputError if the faces cannot be combined with the medium, the lights or the views.
void check_faces(const Scene& scene);
/// Throws InputError if only the power of light at the faces is known, not the fields.
void refuse_unpolarised(const Scene& scene);

/// Throws InputError if the index varies. what: name of the method that does not support this.
void refuse_graded(const Scene& scene, const std::string& what);

}  // namespace flatspeckle
