#pragma once

#include <utility>
#include <vector>

#include "mc/slab/adding/layer.h"
#include "mc/slab/adding/layer_waves.h"
#include "mc/slab/adding/ordinates.h"

namespace flatspeckle::mc {

/// Transport of field pairs with one transverse momentum (C36, C41), expanded in functions of
/// direction. Function m is the cosine of mode m; in space, function highest + m is the sine of
/// mode m. Scattering does not couple modes; the transverse momentum couples mode m to modes m - 1
/// and m + 1. Coefficients of odd modes are divided by i; then all quantities except the
/// illuminations are real.
template <typename Geometry, typename Number>
class DirectionModesOf {
 public:
  using Slab = SlabOf<Geometry, Number>;
  using Discrete = DiscreteSlabOf<Geometry, Number>;
  using Momentum = typename Geometry::Momentum;
  using Pairs = std::vector<PairOf<typename Geometry::Direction>>;
  using Layer = HomogeneousLayerOf<Number>;

  /// Expands in the modes m = 0 .. highest.
  DirectionModesOf(const Slab& slab, const Discrete& discrete, int highest,
                   const Momentum& momentum, const Pairs& lights, const Pairs& views);

  /// Constructs the expansion for zero transverse momentum. endpoints: for each layer, the waves of
  /// illuminations and views, expanded in all functions of direction.
  DirectionModesOf(const Slab& slab, const Discrete& discrete, int highest,
                   std::vector<EndpointWavesOf<Number>> endpoints)
      : slab_(slab),
        discrete_(discrete),
        highest_(highest),
        q_(0),
        endpoints_(std::move(endpoints)) {}

  /// A set of functions of direction that are not coupled to functions outside the set. The first
  /// `even` functions in the list belong to even modes.
  struct Part {
    std::vector<int> functions;
    int even;
  };
  /// Returns the sets of functions that are solved separately: all cosines and, in space, all
  /// sines. For zero transverse momentum each function is a set by itself.
  std::vector<Part> parts() const;
  /// Returns the layers, expanded in the functions of a part. The list is empty if the
  /// illuminations contribute nothing to these functions, or the views collect nothing from them.
  std::vector<Layer> layers(const Part& part) const;
  /// Returns the reflection at the faces for the functions of a part.
  FaceReflectances faces(const Part& part) const {
    return {discrete_.reflectances(slab_), std::ssize(part.functions)};
  }

 private:
  using Real = RealOf<Number>;
  using Waves = PairWavesOf<Number>;
  using Scattering = typename Discrete::Ordinates::Scattering;
  /// Returns the number of functions of direction.
  Eigen::Index functions() const { return 1 + Geometry::function_kinds * highest_; }
  int mode(int function) const { return function > highest_ ? function - highest_ : function; }
  double q(std::size_t layer) const;
  /// Returns the extinction coefficient of a layer, in units of its mu_t, without the scattering
  /// into the forward peak of its phase function.
  Number extinction(std::size_t layer) const;
  using LayerWaves = LayerWavesOf<Geometry, Number>;
  TransportOperatorOf<Number> transport(std::size_t layer, const Part& part) const;
  MatrixOf<Number> block(std::size_t layer, const Part& part,
                         MatrixOf<Real> Scattering::*scattering) const;
  Waves part_of(const Waves& all, const Part& part) const;
  bool is_dark(const Part& part, Waves EndpointWavesOf<Number>::*waves) const;

  const Slab& slab_;
  const Discrete& discrete_;
  int highest_;
  double q_;  ///< transverse momentum in units of the slab's mu_t
  std::vector<EndpointWavesOf<Number>> endpoints_;  ///< waves of each layer, in all functions
};

}  // namespace flatspeckle::mc
