#pragma once

#include "grin/media/index/index_field.h"

namespace flatspeckle::grin {

// Rays side by side in lanes, which loops over all of them make vectors of: nothing in such a loop
// depends on another lane, so that what becomes of a ray depends neither on its lane nor on its
// neighbours, nor on how wide vectors are but for fused multiply-adds, which SSE2 has none of.

/// Three of the widest vectors: a step is a long chain, of which some work while others wait; and
/// so few that short batches fill them.
inline constexpr int lanes = 24;

struct LaneVectors {
  alignas(64) double x[lanes], y[lanes], z[lanes];

  Vec3 at(int lane) const { return {x[lane], y[lane], z[lane]}; }
  void put(int lane, const Vec3& v) {
    x[lane] = v[0];
    y[lane] = v[1];
    z[lane] = v[2];
  }
};

/// IndexGradient.
struct LaneGradients {
  alignas(64) double excess[lanes];
  LaneVectors gradient;
};

/// A field that tells its gradients in lanes, for less than one by one; NaN where it would be slow
/// at that: there a ray goes by itself.
template <class F>
concept LaneField = IndexField<F> &&
    requires(const F& field, const LaneVectors& x, LaneGradients& found) {
  field.gradients(x, found);
};

/// Of any field: one by one where it has none in lanes.
template <IndexField F>
void lane_gradients(const F& field, const LaneVectors& x, LaneGradients& found) {
  if constexpr (LaneField<F>) {
    field.gradients(x, found);
  } else {
    for (int lane = 0; lane < lanes; ++lane) {
      const IndexGradient at = field.gradient(x.at(lane));
      found.excess[lane] = at.excess;
      found.gradient.put(lane, at.gradient);
    }
  }
}

}  // namespace flatspeckle::grin
