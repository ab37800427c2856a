#pragma once

#include <vector>

#include "core/algebra/dual_dense.h"

namespace flatspeckle::mc {

/// Homogeneous transport at one transverse frequency (C36), z in mean free paths: of radiance down,
/// L+, and up, L-, at n ordinates, in a basis in which all is real,
///   S' = -x D,  D' = -y S,  S = L+ + L-,  D = L+ - L-.
/// x and y with the signs of all but the first `even` rows turned are symmetric.
template <typename Number>
struct TransportOperatorOf {
  MatrixOf<Number> x, y;
  Eigen::Index even = 0;
  double fastest = 0;  ///< bounds the rates of change along z
};
using TransportOperator = TransportOperatorOf<double>;

/// Pairs of lights or of views, a row each: what exp(top z + bottom (depth - z)) of a light feeds
/// into L+ and L- per mean free path, or a view of that sensitivity collects from L- and L+ (turned
/// round: a view is a light that time runs backwards for). Signs of all but the first `even`
/// columns are turned.
template <typename Number>
struct PairWavesOf {
  std::vector<ComplexOf<Number>> top, bottom;
  RowsOf<Number> down, up;
};
using PairWaves = PairWavesOf<double>;

/// Of both ends of a slab's paths.
template <typename Number>
struct EndWavesOf {
  PairWavesOf<Number> lights, views;
};

/// What leaves the slab through its faces, a row for each light, and what views collect of it,
/// [view][light]. Signs as above.
template <typename Number>
struct LayerResponseOf {
  RowsOf<Number> up, down;
  RowsOf<Number> collected;
};
using LayerResponse = LayerResponseOf<double>;

/// By doubling from a layer so thin that its series converge to rounding. Number: double,
/// Complex for complex extinction, or Dual<double> for derivatives too.
template <typename Number>
LayerResponseOf<Number> layer_response(const TransportOperatorOf<Number>& medium,
                                       RealOf<Number> depth, const PairWavesOf<Number>& lights,
                                       const PairWavesOf<Number>& views);

/// One of several layers on the same ordinates, with what those above and below leave of its
/// lights and views where they enter it.
struct StackedLayer {
  TransportOperator medium;
  double depth;
  PairWaves lights, views;
  std::vector<Complex> light_factors, view_factors;
};

/// Of layers from the top down, by the star product.
LayerResponse stack_response(const std::vector<StackedLayer>& layers);

}  // namespace flatspeckle::mc
