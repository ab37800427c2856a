#pragma once

#include "grin/media/index/field_kind.h"

namespace flatspeckle::grin {

// Common parts of light guides that are rotationally symmetric about an axis along z.

inline FieldFacts guide_facts(double alpha, const Vec3& centre) {
  return {.scale = 1 / alpha, .symmetry = Symmetry::round_guide, .centre = centre};
}

struct GuideValues {
  static constexpr bool is_medium = true;
  double index = 1;
  std::optional<double> alpha = {};
  std::vector<double> centre{0, 0, 0};
};

inline void add_keys(Keys& keys, GuideValues& values) {
  add_index_key(keys, values.index, "n0 on the axis");
  keys.add("alpha", values.alpha,
           "Gradient constant of n^2 = n0^2 - alpha^2 rho^2 (parabolic) or n = n0 sech(alpha rho) "
           "(sech)")
      .positive()
      .unit("1/length");
  add_vector(keys, "centre", values.centre, "A point on the axis, which is along z").unit("length");
}

}  // namespace flatspeckle::grin
