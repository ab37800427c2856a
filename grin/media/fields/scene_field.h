#pragma once

#include <string>
#include <variant>
#include <vector>

#include "grin/media/fields/any_index_field.h"

namespace flatspeckle::grin {

/// Scene keys of an index field: the names of one or several kinds of field, which are summed, and
/// the values of each kind.
struct IndexFieldValues {
  std::vector<std::string> field{"homogeneous"};
  IndexFieldKinds kinds{};

  template <class Kind>
  Kind& of() {
    return std::get<Kind>(kinds);
  }
};

void add_keys(Keys& keys, IndexFieldValues& values);

/// An index field and its properties (FieldFacts).
struct SceneField : FieldFacts {
  AnyIndexField field;
  /// Field outside the surface `rim` (FieldFacts).
  std::variant<Homogeneous, AnySum> outside = {};
};

/// Makes the index field from its scene keys. Throws InputError for invalid values.
SceneField make_scene_field(const Keys& keys, const IndexFieldValues& values, const FieldUse& use);

/// Returns the index at x; 0 outside the grid of the field and where the index is not positive.
double index_at(const SceneField& scene, const Vec3& x);

}  // namespace flatspeckle::grin
