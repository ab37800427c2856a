#pragma once

#include "mc/space/space_slope.h"
#include "mc/transport/pair_wave.h"

namespace flatspeckle::mc {

/// A slab in space, and how the second fields of pairs, or what it is differentiated by, depart
/// from it. Lengths in one unit.
template <typename Number>
struct SpaceSlabOf {
  double k, mu_t, depth;
  RealOf<Number> albedo;
  SpaceLawOf<Number> law;
  Departure<Number> departure{};

  RealOf<Number> optical_depth() const { return mu_t * depth / departure.length; }
  double k_per_mu_t() const { return k / mu_t; }
};
using SpaceSlab = SpaceSlabOf<double>;

}  // namespace flatspeckle::mc
