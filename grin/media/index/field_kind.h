#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "core/keys/keys.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/media/index/index_field.h"

namespace flatspeckle::grin {

// A kind of index field is a file with: the field, a concept IndexField; its facts(field); its
// values, with the word of the key `field` for it and whether it is a medium or added to one;
// add_keys(keys, values); and make_field(keys, values, use). It is listed in any_index_field.h.

/// What a ray keeps by the symmetry of the field (conventions, C27).
enum class Symmetry { none, sphere, guide, round_guide, stratified };

/// What the use of a field must know of it.
struct FieldFacts {
  double scale = 0;  ///< over which the index varies; 0: nowhere
  /// By how much it does; its gradient is nowhere more than this by the scale.
  double strength = std::numeric_limits<double>::infinity();
  std::vector<Vec3> places = {};  ///< where it does, if that may be in a small part of space
  Symmetry symmetry = Symmetry::none;
  Vec3 centre = Vec3::Zero(), axis = Vec3::UnitZ();
  std::optional<Sphere> rim = {};  ///< of a ball, where the gradient jumps: the field is inside
  std::optional<Box> grid = {};    ///< beyond which there is no field
};

/// What a field is made for.
struct FieldUse {
  double reach;                            ///< distance from the z axis that rays stay within
  bool any_phase = false;                  ///< each path meets sound at a phase of its own
  bool is_added = false;                   ///< to another field's index
  std::optional<double> length_unit = {};  ///< metres, where that is known
};

/// Excess of the index that a field stands on.
inline double background(const Keys& keys, const double& index, const FieldUse& use) {
  return use.is_added ? 0 : keys.read(index) - 1;
}

inline void add_index_key(Keys& keys, double& index, const std::string& where) {
  keys.add("index", index, "Index " + where).positive();
}

}  // namespace flatspeckle::grin
