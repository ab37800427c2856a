#pragma once

#include "grin/media/index/field_kind.h"
#include "grin/media/index/radial_field.h"

namespace flatspeckle::grin {

/// Maxwell's fisheye lens, n = n0 / (1 + r^2/a^2), at the distance r from the centre; a is its
/// radius and n0 is 1 + centre_excess.
struct FisheyeProfile {
  static constexpr bool goes_in_lanes = true;
  double centre_excess = 1, radius = 1;

  double excess(double u) const {
    const double q = u / (radius * radius);
    return (centre_excess - q) / (1 + q);
  }
  RadialJet jet(double u) const {
    const double area = radius * radius, q = u / area, w = 1 / (1 + q);
    const double first = -(1 + centre_excess) * w * w / area;
    return {(centre_excess - q) * w, first, -2 * first * w / area};
  }
};
using Fisheye = RadialField<FisheyeProfile, 3>;

/// Returns the field unchanged. It is smooth everywhere, also beyond the sphere on which rays end.
inline Fisheye smooth_within(const Fisheye& field, const Sphere& /*end*/) {
  return field;
}

inline FieldFacts facts(const Fisheye& field) {
  return {.scale = field.profile().radius, .symmetry = Symmetry::sphere, .centre = field.centre()};
}

struct FisheyeValues {
  using Field = Fisheye;
  static constexpr const char* word = "fisheye";
  static constexpr bool is_medium = true;
  double index = 2, radius = 1;
  std::vector<double> centre{0, 0, 0};
};

inline void add_keys(Keys& keys, FisheyeValues& values) {
  add_index_key(keys, values.index, "in the centre");
  keys.add("radius", values.radius, "Radius at which the index is half its value at the centre")
      .positive()
      .unit("length");
  add_vector(keys, "centre", values.centre, "Centre of the field").unit("length");
}

inline Fisheye make_field(const Keys& keys, const FisheyeValues& values, const FieldUse&) {
  return Fisheye({keys.read(values.index) - 1, keys.read(values.radius)},
                 vector_of(keys.read(values.centre)));
}

}  // namespace flatspeckle::grin
