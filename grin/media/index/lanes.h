#pragma once

#include "grin/media/index/index_field.h"

namespace flatspeckle::grin {

// Rays are traced in SIMD lanes, one ray in each. Loops over all lanes are vectorised, and no lane
// depends on another. The result of a ray therefore depends neither on its lane nor on the rays in
// other lanes. It depends on the vector width only through fused multiply-adds, which SSE2 lacks.

/// Number of lanes: three times the width of the widest vectors. This is enough to hide the latency
/// of the long chain of operations in a step, and few enough for short batches of rays to fill all
/// lanes.
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

/// The index n = 1 + excess and its gradient, in each lane.
struct LaneGradients {
  alignas(64) double excess[lanes];
  LaneVectors gradient;
};

/// A field whose function gradients() computes the gradients in all lanes at less cost than one by
/// one. It returns NaN in lanes where this would be slow; the ray of such a lane is then traced
/// alone.
template <class F>
concept LaneField = IndexField<F> &&
    requires(const F& field, const LaneVectors& x, LaneGradients& found) {
  field.gradients(x, found);
};

/// Computes the gradients of any field in lanes, one by one if the field is not a LaneField.
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
