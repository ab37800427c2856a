#pragma once

#include <string>
#include <variant>
#include <vector>

#include "grin/media/fields/any_index_field.h"

namespace flatspeckle::grin {

/// An index field as keys have it: the words of one kind or of several that add up, and what each
/// kind needs.
struct IndexFieldValues {
  std::vector<std::string> field{"homogeneous"};
  IndexFieldKinds kinds{};

  template <class Kind>
  Kind& of() {
    return std::get<Kind>(kinds);
  }
};

void add_keys(Keys& keys, IndexFieldValues& values);

/// A field and what its use must know of it.
struct SceneField : FieldFacts {
  AnyIndexField field;
  std::variant<Homogeneous, AnySum> outside = {};  ///< of the rim
};

/// Throws InputError.
SceneField make_scene_field(const Keys& keys, const IndexFieldValues& values, const FieldUse& use);

/// 0 where there is no field.
double index_at(const SceneField& scene, const Vec3& x);

}  // namespace flatspeckle::grin
