#pragma once

#include <utility>
#include <vector>

#include "mc/slab/adding/layer.h"
#include "mc/slab/adding/ordinates.h"

namespace flatspeckle::mc {

/// Transport of pairs of one transverse momentum (C36, C41) by functions of direction: for each
/// mode m its cosines, of number m, and in space its sines, of number highest + m. Scattering keeps
/// the mode, the momentum couples neighbours; odd modes are taken over i, so that everything is
/// real but the lights.
template <typename Geometry, typename Number>
class DirectionModesOf {
 public:
  using Slab = SlabOf<Geometry, Number>;
  using Discrete = DiscreteSlabOf<Geometry, Number>;
  using Momentum = typename Geometry::Momentum;
  using Pairs = std::vector<PairOf<typename Geometry::Direction>>;
  using Layer = HomogeneousLayerOf<Number>;

  /// Modes m = 0 .. highest.
  DirectionModesOf(const Slab& slab, const Discrete& discrete, int highest,
                   const Momentum& momentum, const Pairs& lights, const Pairs& views);

  /// Without transverse momentum: of lights and views of all functions, per layer.
  DirectionModesOf(const Slab& slab, const Discrete& discrete, int highest,
                   std::vector<EndWavesOf<Number>> ends)
      : slab_(slab), discrete_(discrete), highest_(highest), q_(0), ends_(std::move(ends)) {}

  /// Functions that no other ones are coupled to, those of even modes first.
  struct Part {
    std::vector<int> functions;
    int even;
  };
  /// Cosines and sines; without momentum each function alone.
  std::vector<Part> parts() const;
  /// None where the lights feed nothing into the part, or the views collect nothing of it.
  std::vector<Layer> layers(const Part& part) const;

 private:
  using Real = RealOf<Number>;
  using Waves = PairWavesOf<Number>;
  using Scattering = typename Discrete::Ordinates::Scattering;
  int mode(int function) const { return function > highest_ ? function - highest_ : function; }
  double q(std::size_t layer) const;
  /// Per mu_t of the layer, without what its peak scatters.
  Number extinction(std::size_t layer) const;
  EndWavesOf<Number> ends(std::size_t layer, const Momentum& momentum, const Pairs& lights,
                          const Pairs& views) const;
  TransportOperatorOf<Number> transport(std::size_t layer, const Part& part) const;
  MatrixOf<Number> block(std::size_t layer, const Part& part,
                         MatrixOf<Real> Scattering::*scattering) const;
  Waves part_of(const Waves& all, const Part& part) const;
  bool is_dark(const Part& part, Waves EndWavesOf<Number>::*waves) const;

  const Slab& slab_;
  const Discrete& discrete_;
  int highest_;
  double q_;                              ///< per mu_t of the slab
  std::vector<EndWavesOf<Number>> ends_;  ///< of all functions, per layer
};

}  // namespace flatspeckle::mc
