#pragma once

#include <vector>

#include "mc/transport/angular_grid.h"
#include "mc/transport/bulk_slope.h"
#include "mc/transport/double_scattering.h"
#include "mc/transport/layer.h"
#include "mc/transport/pair_wave.h"

namespace flatspeckle::mc {

/// Independent parts: both parities together, or without transverse momentum each alone.
enum class Parity { even, odd, both };

/// Transport through a medium on an angular grid, in Galerkin's form: scattering from the
/// polynomials of one panel into those of another is integrated exactly, so that it conserves
/// energy and is reciprocal on any grid, and forward peaks that the ordinates do not see cost no
/// accuracy where radiance is smooth. Unknowns are radiance times sqrt(weight cos(theta)), its
/// parts even in theta and those odd, over i, in theta: so everything is real but the lights.
template <typename Number>
class ScatteringMatricesOf {
 public:
  using C = ComplexOf<Number>;
  using M = MatrixOf<Number>;
  using Law = LawOf<Number>;
  using Waves = PairWavesOf<Number>;
  using Ends = EndWavesOf<Number>;
  using Parity = flatspeckle::mc::Parity;

  /// extinction: over mu_t, with C39's difference in wavenumber.
  ScatteringMatricesOf(const AngularGrid& grid, const Law& law, RealOf<Number> albedo,
                       Number extinction = {1}, const Departure<Number>& departure = {});

  static std::vector<Parity> parities(double q);
  TransportOperatorOf<Number> transport(double q, Parity parity) const;

  /// What pairs feed, and what views collect: waves of lights and of views turned round; shares of
  /// mu_t.
  Ends ends(const Scene& scene, const std::vector<Pair>& lights, const std::vector<Pair>& views,
            Parity parity) const;

  /// What these ordinates make of paths of two scatterings, of one light and one view by number.
  C double_scattering(const DoubleScatteringOf<Number>& paths, const Waves& lights,
                      Eigen::Index light, const Waves& views, Eigen::Index view,
                      Parity parity) const;

 private:
  struct Blocks {
    MatrixOf<RealOf<Number>> even, odd;
  };
  M block(double q, const Blocks& scattering, Parity parity) const;
  Waves waves(const std::vector<Pair>& pairs, Parity parity) const;

  const AngularGrid& grid_;
  const Law& law_;
  RealOf<Number> albedo_;
  Number extinction_;
  Departure<Number> departure_;
  Eigen::VectorXd root_;     ///< 1 / sqrt(weight cos(theta))
  Blocks sum_, difference_;  ///< forward plus, minus backward scattering, times the albedo
};
using ScatteringMatrices = ScatteringMatricesOf<double>;

}  // namespace flatspeckle::mc
