#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "grin/media/fields/scene_field.h"
#include "grin/media/index/index_field.h"
#include "grin/rays/surfaces/lens.h"
#include "grin/rays/surfaces/signed_distance.h"
#include "grin/render/stage/stage.h"

namespace flatspeckle::grin {

/// Values of the keys on how a mesh becomes a smooth surface.
struct MeshValues {
  std::optional<double> spacing{}, weld{};
  double crease = 0.52;
};

/// Values of the keys of bodies with constant index and medium, one body per row of numbers or
/// mesh.
struct PlainBodyValues {
  std::vector<double> ball{}, block{}, cylinder{}, lens{}, asphere{}, asphere_terms{};
  std::vector<std::string> ball_face{}, block_face{}, cylinder_face{}, lens_face{}, asphere_face{};
  std::vector<double> block_turns{}, lens_turns{}, asphere_turns{};
  std::vector<std::string> mesh{};
  std::vector<double> mesh_material{};
  std::vector<std::string> lens_glass{};
  std::optional<double> wavelength{};
  MeshValues mesh_shape{};
};

void add_keys(Keys& keys, PlainBodyValues& values);

/// Makes the bodies. length_unit: metres in a unit of length, if known, which glasses require.
/// Throws InputError for numbers out of range.
std::vector<Body> make_plain_bodies(const Keys& keys, const PlainBodyValues& values,
                                    const std::optional<double>& length_unit);
/// Throws InputError for a body that is not within a region. name: what the message calls the
/// region.
void check_within(const Body& body, const Surface& region, const std::string& name);

/// Sorts bodies by decreasing volume, so that smaller bodies replace larger ones where they
/// overlap. Bodies of equal volume, to rounding, keep their order.
void sort_by_size(std::vector<Body>& bodies);

// Numbers that define a lens in keys.
inline constexpr int lens_numbers = 7;
inline constexpr const char* lens_words = "x y z radius front back thickness";

/// Makes a lens of lens_numbers numbers. Throws InputError, naming the key, for an invalid lens.
Lens lens_of(const std::string& key, std::span<const double> numbers);

/// Keys that define a body.
inline constexpr const char* body_key_names = "body_box, body_sphere, body_lens, body_mesh";

/// Values of the keys of the body that an index field fills, and of the index around it.
struct FieldBodyValues {
  std::vector<double> body_box{}, body_sphere{}, body_lens{};
  std::string body_mesh{};
  MeshValues body_mesh_shape{};
  double index_around = 1;
};

/// Add the keys of the body, and the key of the index around it. The two are in different groups of
/// keys.
void add_body_keys(Keys& keys, FieldBodyValues& values);
void add_index_around(Keys& keys, FieldBodyValues& values);

/// Returns the only surface given, nullopt if there is none. Throws InputError if several are
/// given.
std::optional<Surface> one_surface(const std::string& name, const std::string& keys,
                                   const std::vector<Surface>& given);
/// Surface of a body, and a note for the user on how it was made, if there is one.
struct GivenBody {
  Surface surface;
  std::string note = {};
};

/// Returns the body given, if any. stage: boundary of the stage, or null. A mesh that extends
/// beyond it is rejected before it is processed.
std::optional<GivenBody> given_body(const Keys& keys, const FieldBodyValues& values,
                                    const Surface* stage = nullptr);

/// Returns the range of the index of a field in a region. name: what messages call the region.
/// Throws InputError for a field that does not cover the region, or has an index that is not
/// positive there.
IndexRange check_field(const SceneField& field, const Surface& region, const std::string& name);
/// Throws InputError for a body that extends beyond the rim of the field, if the field has one
/// (luneburg).
void check_rim(const SceneField& field, const Surface& body);

}  // namespace flatspeckle::grin
