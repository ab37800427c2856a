#pragma once

#include <optional>
#include <variant>

#include "apps/index_field_options.h"
#include "grin/fields/any_index_field.h"
#include "grin/surfaces/signed_distance.h"

namespace flatspeckle::apps {

/// What a ray keeps by the symmetry of the field (conventions, C27).
enum class Symmetry { none, sphere, guide, round_guide, stratified };

/// A field and what its use must know of it.
struct SceneField {
  grin::AnyIndexField field;
  double scale;  ///< over which the index varies; 0: nowhere
  Symmetry symmetry = Symmetry::none;
  grin::Vec3 centre = grin::Vec3::Zero(), axis = grin::Vec3::UnitZ();
  std::optional<grin::Sphere> rim;  ///< of a ball, where the gradient jumps: `field` is inside
  std::variant<grin::Homogeneous, grin::AnySum> outside;  ///< of the rim
  std::optional<grin::Box> grid;                          ///< beyond which there is no field
};

/// reach: the distance from the z axis that the rays stay within. Throws InputError, also for keys
/// that the field has no use for.
SceneField make_index_field(const Subcommand& command, const IndexFieldSpec& spec, double reach);

/// 0 where there is no field.
double index_at(const SceneField& scene, const grin::Vec3& x);

}  // namespace flatspeckle::apps
