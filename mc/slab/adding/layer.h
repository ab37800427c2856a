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
///
/// The response of the layer to wave w is multiplied by factor[w] and is added to that of pair w %
/// pairs: a pair has a second wave if faces reflect it.
template <typename Number>
struct PairWavesOf {
  std::vector<ComplexOf<Number>> top, bottom;
  RowsOf<Number> down, up;
  std::vector<ComplexOf<Number>> factor;
  Eigen::Index pairs = 0;
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

/// Reflection at the faces of a stack of layers. reflectance[l]: fraction of the power that face l,
/// above layer l or below the last layer, reflects at each ordinate of the medium with the larger
/// refractive index; for the first and the last face, at each ordinate inside. The first ordinates
/// of two media with equal transverse momentum correspond to each other. Empty without faces.
struct FaceReflectances {
  std::vector<Eigen::VectorXd> reflectance;
  Eigen::Index functions = 1;  ///< functions of direction, each with values at all ordinates
};

/// Computes the response of a stack of layers, listed from the top down. Each layer is built by
/// doubling, starting from a layer so thin that its power series converges to rounding error.
/// Layers and faces are combined by the Redheffer star product. Radiance leaves the response
/// outside of the faces.
/// Number: double, Complex for complex extinction, or Dual<double> to include derivatives.
template <typename Number>
LayerResponseOf<Number> response_of(const std::vector<HomogeneousLayerOf<Number>>& layers,
                                    const FaceReflectances& faces = {});

}  // namespace flatspeckle::mc
