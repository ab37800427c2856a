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

/// Bodies whose index and medium are the same everywhere, as keys have them: as many as there are
/// rows of numbers.
struct PlainBodyValues {
  std::vector<double> ball{}, block{}, lens{};
};

void add_keys(Keys& keys, PlainBodyValues& values);

/// Throws InputError for numbers out of range.
std::vector<Body> make_plain_bodies(const Keys& keys, const PlainBodyValues& values);
/// And for a body that is not within a region; name: of that.
void check_within(const Body& body, const Surface& region, const std::string& name);

/// A smaller body, by its volume, lies over a larger one; of those equal to rounding the later.
void sort_by_size(std::vector<Body>& bodies);

// The numbers of a lens as keys have them.
inline constexpr int lens_numbers = 7;
inline constexpr const char* lens_words = "x y z radius front back thickness";

/// Of that many numbers. Throws InputError, naming the key, for what is no lens.
Lens lens_of(const std::string& key, std::span<const double> numbers);

/// The keys that name a body.
inline constexpr const char* body_key_names = "body_box, body_sphere, body_lens, body_mesh";

/// The body that an index field fills, and the index around it, as keys have them.
struct FieldBodyValues {
  std::vector<double> body_box{}, body_sphere{}, body_lens{};
  std::string body_mesh{};
  std::optional<double> body_mesh_spacing{};
  double index_around = 1;
};

/// The rows of the body, and of the index around it, which stand in different groups.
void add_body_keys(Keys& keys, FieldBodyValues& values);
void add_index_around(Keys& keys, FieldBodyValues& values);

/// What one of some keys says; nothing where none is given. Throws InputError.
std::optional<Surface> one_surface(const std::string& name, const std::string& keys,
                                   const std::vector<Surface>& given);
/// room: a mesh beyond it is refused before it costs anything; or null.
std::optional<Surface> given_body(const Keys& keys, const FieldBodyValues& values,
                                  const Surface* room = nullptr);

/// Throws InputError for a field that ends, or has no index above 0, somewhere in a region; name:
/// of that. Returns the range of its index there.
IndexRange check_field(const SceneField& field, const Surface& region, const std::string& name);
/// And for a body beyond the rim of a ball.
void check_rim(const SceneField& field, const Surface& body);

}  // namespace flatspeckle::grin
