#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "core/keys/keys.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/media/index/index_field.h"

namespace flatspeckle::grin {

// Each kind of index field has its own header. It declares the class of the field, which models the
// concept IndexField; facts(field); a struct of the scene keys, with the name of the kind in the
// key `field` (word) and whether the field is a medium or is added to one (is_medium);
// add_keys(keys, values); and make_field(keys, values, use). any_index_field.h lists all kinds.

/// Symmetry of the index field, which determines the quantities that are constant along a ray
/// (conventions, C27).
enum class Symmetry { none, sphere, guide, round_guide, stratified };

/// Properties of an index field from which integration methods and step lengths for rays are
/// chosen.
struct FieldFacts {
  double scale = 0;  ///< length over which the index varies; 0 for a uniform index
  /// Magnitude of the variation of the index. The gradient of the index is nowhere larger than
  /// strength / scale.
  double strength = std::numeric_limits<double>::infinity();
  std::vector<Vec3> places = {};  ///< points where the index varies, for fields that may vary only
                                  ///< in a small part of space
  Symmetry symmetry = Symmetry::none;
  Vec3 centre = Vec3::Zero(), axis = Vec3::UnitZ();
  /// Surface of the ball that contains the field. The gradient of the index jumps there.
  std::optional<Sphere> rim = {};
  double excess_beyond_rim = 0;  ///< index - 1 outside the rim
  std::optional<Box> grid = {};  ///< box outside which there is no field
};

/// Conditions under which a field is used.
struct FieldUse {
  double reach;            ///< largest distance of rays from the z axis
  bool any_phase = false;  ///< whether each path has its own phase of the sound
  bool is_added = false;   ///< whether the field is added to the index of another field
  std::optional<double> length_unit = {};  ///< unit of length in metres, if given
};

/// Returns the background index of a field minus 1; 0 if the field is added to another field, which
/// has the background.
inline double background(const Keys& keys, const double& index, const FieldUse& use) {
  return use.is_added ? 0 : keys.read(index) - 1;
}

inline void add_index_key(Keys& keys, double& index, const std::string& where) {
  keys.add("index", index, "Index " + where).positive();
}

}  // namespace flatspeckle::grin
