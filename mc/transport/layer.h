#pragma once

#include <vector>

#include "core/numbers/complex.h"
#include "mc/transport/dense.h"

namespace flatspeckle::mc {

/// Homogeneous transport at one transverse frequency (C36), z in mean free paths: of radiance down,
/// L+, and up, L-, at n ordinates, in a basis in which all is real,
///   S' = -x D,  D' = -y S,  S = L+ + L-,  D = L+ - L-.
/// x and y with the signs of all but the first `even` rows turned are symmetric.
struct TransportOperator {
  Matrix x, y;
  Eigen::Index even = 0;
  double fastest = 0;  ///< bounds the rates of change along z
};

/// Pairs of lights or of views, a row each: what exp(top z + bottom (depth - z)) of a light feeds
/// into L+ and L- per mean free path, or a view of that sensitivity collects from L- and L+ (turned
/// round: a view is a light that time runs backwards for). Signs of all but the first `even`
/// columns are turned.
struct PairWaves {
  std::vector<Complex> top, bottom;
  Rows down, up;
};

/// What leaves the slab through its faces, a row for each light, and what views collect of it,
/// [view][light]. Signs as above.
struct LayerResponse {
  Rows up, down;
  Rows collected;
};

/// By doubling from a layer so thin that its series converge to rounding.
LayerResponse layer_response(const TransportOperator& medium, double depth, const PairWaves& lights,
                             const PairWaves& views);

}  // namespace flatspeckle::mc
