#pragma once

#include <vector>

#include "core/algebra/dual_dense.h"

namespace flatspeckle::mc {

/// Transport equation of a homogeneous layer at one transverse frequency (C36), with the depth z in
/// mean free paths. L+ is downward and L- upward radiance at n ordinates, in a basis in which the
/// coefficients are real:
///   S' = -x D,  D' = -y S,  S = L+ + L-,  D = L+ - L-.
/// The matrices x and y become symmetric if the signs of all but the first `even` rows are flipped.
template <typename Number>
struct TransportOperatorOf {
  MatrixOf<Number> x, y;
  Eigen::Index even = 0;
  double fastest = 0;  ///< upper bound of the rates at which radiance varies with z
};

/// Pairs of illuminations or of views, one per row. A pair of illuminations has the intensity
/// exp(top z + bottom (depth - z)) at depth z; `down` and `up` contain the radiance that its
/// scattering adds to L+ and L- per mean free path. For a pair of views, `down` and `up` contain
/// the sensitivity to L- and L+, in this reversed order because by reciprocity a view is a
/// time-reversed illumination. The signs of all but the first `even` columns are flipped.
template <typename Number>
struct PairWavesOf {
  std::vector<ComplexOf<Number>> top, bottom;
  RowsOf<Number> down, up;
};

/// Waves of the illuminations and of the views of a layer.
template <typename Number>
struct EndpointWavesOf {
  PairWavesOf<Number> lights, views;
};

/// Radiance that leaves the slab upwards and downwards, one row per illumination, with signs
/// flipped as in PairWavesOf; and the signal that the views collect, [view][light].
template <typename Number>
struct LayerResponseOf {
  RowsOf<Number> up, down;
  RowsOf<Number> collected;
};

/// One layer of a slab, with its depth in mean free paths. All layers of a slab use the same
/// ordinates.
template <typename Number>
struct HomogeneousLayerOf {
  TransportOperatorOf<Number> medium;
  RealOf<Number> depth;
  PairWavesOf<Number> lights, views;
};

/// Computes the response of a stack of layers, listed from the top down. Each layer is built by
/// doubling, starting from a layer so thin that its power series converges to rounding error.
/// Layers are combined by the Redheffer star product, which could also include reflecting faces.
/// Number: double, Complex for complex extinction, or Dual<double> to include derivatives.
template <typename Number>
LayerResponseOf<Number> response_of(const std::vector<HomogeneousLayerOf<Number>>& layers);

/// Returns the factors by which waves are attenuated in all other layers on their way to each
/// layer, [layer][wave]. A layer as a whole attenuates a wave from above by exp(top) and a wave
/// from below by exp(bottom), [layer][wave].
template <typename C>
std::vector<std::vector<C>> entering(const std::vector<std::vector<C>>& top,
                                     const std::vector<std::vector<C>>& bottom) {
  using std::exp;
  auto factors = top;
  for (std::size_t l = 0; l < top.size(); ++l)
    for (std::size_t w = 0; w < top[l].size(); ++w) {
      C exponent{};
      for (std::size_t m = 0; m < top.size(); ++m)
        if (m != l) exponent += m < l ? top[m][w] : bottom[m][w];
      factors[l][w] = exp(exponent);
    }
  return factors;
}

}  // namespace flatspeckle::mc
