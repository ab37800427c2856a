#pragma once

#include <vector>

#include "mc/space/polar_matrices.h"
#include "mc/space/space_chains.h"
#include "mc/space/space_slab.h"
#include "mc/transport/layer.h"

namespace flatspeckle::mc {

/// Transport in space at one transverse momentum (C41): ScatteringMatrices of the plane for each
/// Fourier mode of the azimuth about z, cos(m phi) or sin(m phi), phi from the momentum. Scattering
/// keeps the mode, the momentum couples neighbours by cos(phi); odd modes are taken over i, so that
/// everything is real but the lights.
template <typename Number>
class AzimuthalModesOf {
 public:
  using Slab = SpaceSlabOf<Number>;
  using Polar = PolarMatricesOf<RealOf<Number>>;
  using Waves = PairWavesOf<Number>;
  using Ends = EndWavesOf<Number>;

  /// Modes m = 0 .. highest.
  AzimuthalModesOf(const Polar& polar, const Slab& slab, int highest);

  /// Functions of the azimuth that no other ones are coupled to: numbers m of cos(m phi), highest +
  /// m of sin(m phi), those of even m first.
  struct Part {
    std::vector<int> functions;
    int even;
  };
  /// Cosines and sines; without momentum each function alone.
  std::vector<Part> parts(double q) const;
  /// q: per extinction coefficient.
  TransportOperatorOf<Number> transport(double q, const Part& part) const;

  /// Of all functions: what pairs feed, and what views collect; shares of mu_t. x: unit vector
  /// along the momentum.
  Ends ends(const Eigen::Vector2d& x, const std::vector<SpacePair>& lights,
            const std::vector<SpacePair>& views) const;
  Waves part_of(const Waves& all, const Part& part) const;

  /// Power through a face per unknown of m = 0, of radiance in units of light per area across it.
  Eigen::VectorXd power() const;

 private:
  using Real = RealOf<Number>;
  using Scattering = typename Polar::Scattering;
  int mode(int function) const { return function > highest_ ? function - highest_ : function; }
  MatrixOf<Number> block(double q, const Part& part, MatrixOf<Real> Scattering::*scattering) const;
  Waves waves(const Eigen::Vector2d& x, const std::vector<SpacePair>& pairs) const;
  RowsOf<Number> fed(const std::vector<SpacePair>& pairs, const Matrix& directions,
                     const Matrix& azimuthal, double side) const;
  Matrix azimuthal_functions(int steps) const;

  const Polar& polar_;
  const AngularGrid& grid_;
  const Slab& slab_;
  int highest_;
};

}  // namespace flatspeckle::mc
