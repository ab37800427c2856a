#pragma once

#include "mc/slab/adding/bulk_slope.h"
#include "mc/slab/adding/pair_wave.h"
#include "mc/slab/adding/scattering_law.h"

namespace flatspeckle::mc {

/// What two scatterings make of a pair of lights in a pair of views: light scatters towards theta
/// at one depth and into the view at another. An integral over theta alone, the rest is in closed
/// form: exact where forward peaks, or the phase of a large transverse momentum, ask for many
/// ordinates.
template <typename Number>
class DoubleScatteringOf {
 public:
  using C = ComplexOf<Number>;
  using Law = std::conditional_t<std::is_same_v<Number, Dual<double>>, SlopeOf<ScatteringLaw>,
                                 ScatteringLaw>;

  /// k, q: per mu_t.
  DoubleScatteringOf(RealOf<Number> optical_depth, double k, double q, Pair lights, Pair views,
                     const Departure<Number>& departure);

  /// Of unit sources and sensitivities along theta, on the way down or up: per cos(theta).
  C along(double sine, double cosine, bool down) const;

  /// Including both pairs' amplitudes, by quadrature refined to a tolerance.
  C total(const Law& law, double tolerance) const;

 private:
  C integral(const Law& law, double from, double to, double tolerance, C estimate, int depth) const;
  C gauss(const Law& law, double from, double to) const;

  RealOf<Number> optical_depth_, q_;
  Number extinction_;
  Pair lights_, views_;
  PairWaveOf<Number> light_, view_;
};

}  // namespace flatspeckle::mc
