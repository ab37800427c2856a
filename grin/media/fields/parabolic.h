#pragma once

#include <cmath>

#include "grin/media/index/guide.h"
#include "grin/media/index/radial_field.h"

namespace flatspeckle::grin {

/// Parabolic guide: n^2 = n0^2 - alpha^2 rho^2 at the distance rho from its axis, which is along z;
/// n0 = 1 + axis_excess. The index is NaN where n^2 is negative.
struct ParabolicProfile {
  static constexpr bool goes_in_lanes = true;
  double axis_excess, alpha;

  double excess(double u) const {
    const double above = above_one(u);
    return above / (1 + std::sqrt(1 + above));
  }
  RadialJet jet(double u) const {
    const double above = above_one(u), n = std::sqrt(1 + above), a2 = alpha * alpha;
    return {above / (1 + n), -a2 / (2 * n), -a2 * a2 / (4 * n * n * n)};
  }
  RadialSquare square(double u) const {
    const double above = above_one(u), n = std::sqrt(1 + above);
    return {above / (1 + n), n >= 0 ? -alpha * alpha : n};
  }

 private:
  double above_one(double u) const {  // n^2 - 1
    return axis_excess * (2 + axis_excess) - alpha * alpha * u;
  }
};
using ParabolicGuide = RadialField<ParabolicProfile, 2>;

inline FieldFacts facts(const ParabolicGuide& field) {
  return guide_facts(field.profile().alpha, field.centre());
}

struct ParabolicValues : GuideValues {
  using Field = ParabolicGuide;
  static constexpr const char* word = "parabolic";
};

inline ParabolicGuide make_field(const Keys& keys, const ParabolicValues& values, const FieldUse&) {
  return ParabolicGuide({keys.read(values.index) - 1, keys.required(values.alpha)},
                        vector_of(keys.read(values.centre)));
}

}  // namespace flatspeckle::grin
