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

/// Pairs of lights or of views, a row each: what exp(top z + bottom (depth - z)) of a light feeds
/// into L+ and L- per mean free path, or a view of that sensitivity collects from L- and L+ (turned
/// round: a view is a light that time runs backwards for). Signs of all but the first `even`
/// columns are turned.
template <typename Number>
struct PairWavesOf {
  std::vector<ComplexOf<Number>> top, bottom;
  RowsOf<Number> down, up;
};

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

/// One of the layers of a slab, all on the same ordinates.
template <typename Number>
struct HomogeneousLayerOf {
  TransportOperatorOf<Number> medium;
  RealOf<Number> depth;
  PairWavesOf<Number> lights, views;
};

/// Of layers from the top down, each by doubling from one so thin that its series converge to
/// rounding; they are stacked by the star product (Redheffer), where a face that reflects would
/// have its place among them. Number: double, Complex for complex extinction, or Dual<double> for
/// derivatives too.
template <typename Number>
LayerResponseOf<Number> response_of(const std::vector<HomogeneousLayerOf<Number>>& layers);

/// What the layers above and below leave of waves where they enter each layer, [layer][wave]. top
/// and bottom: exponents of a layer as a whole, [layer][wave].
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
