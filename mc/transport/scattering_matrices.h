#pragma once

#include <vector>

#include "mc/transport/angular_grid.h"
#include "mc/transport/double_scattering.h"
#include "mc/transport/layer.h"
#include "mc/transport/pair_wave.h"
#include "mc/transport/scattering_law.h"

namespace flatspeckle::mc {

/// Transport through a medium on an angular grid, in Galerkin's form: scattering from the
/// polynomials of one panel into those of another is integrated exactly, so that it conserves
/// energy and is reciprocal on any grid, and forward peaks that the ordinates do not see cost no
/// accuracy where radiance is smooth. Unknowns are radiance times sqrt(weight cos(theta)), its
/// parts even in theta and those odd, over i, in theta: so everything is real but the lights.
class ScatteringMatrices {
 public:
  ScatteringMatrices(const AngularGrid& grid, const ScatteringLaw& law, double albedo);

  /// Independent parts: both parities together, or without transverse momentum each alone.
  enum class Parity { even, odd, both };
  static std::vector<Parity> parities(double q);
  TransportOperator transport(double q, Parity parity) const;

  /// What pairs feed, and what views collect: waves of lights and of views turned round; shares of
  /// mu_t.
  PairWaves lights(const Scene& scene, const std::vector<Pair>& pairs, Parity parity) const;
  PairWaves views(const Scene& scene, const std::vector<Pair>& pairs, Parity parity) const;

  /// What these ordinates make of paths of two scatterings, of one light and one view by number.
  Complex double_scattering(const DoubleScattering& paths, const PairWaves& lights,
                            Eigen::Index light, const PairWaves& views, Eigen::Index view,
                            Parity parity) const;

 private:
  struct Blocks {
    Matrix even, odd;
  };
  Matrix block(double q, const Blocks& scattering, Parity parity) const;
  PairWaves waves(const std::vector<Pair>& pairs, Parity parity) const;

  const AngularGrid& grid_;
  const ScatteringLaw& law_;
  double albedo_;
  Eigen::VectorXd root_;     ///< 1 / sqrt(weight cos(theta))
  Blocks sum_, difference_;  ///< forward plus, minus backward scattering, times the albedo
};

}  // namespace flatspeckle::mc
