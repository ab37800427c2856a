#pragma once

#include "mc/transport/pair_wave.h"
#include "mc/transport/scattering_law.h"

namespace flatspeckle::mc {

/// What two scatterings make of a pair of lights in a pair of views: light scatters towards theta
/// at one depth and into the view at another. An integral over theta alone, the rest is in closed
/// form: exact where forward peaks, or the phase of a large transverse momentum, ask for many
/// ordinates.
class DoubleScattering {
 public:
  DoubleScattering(const Scene& scene, double q, Pair lights, Pair views);

  /// Of unit sources and sensitivities along theta, on the way down or up: per cos(theta).
  Complex along(double sine, double cosine, bool down) const;

  /// Including both pairs' amplitudes, by quadrature refined to a tolerance.
  Complex total(const ScatteringLaw& law, double tolerance) const;

 private:
  Complex integral(const ScatteringLaw& law, double from, double to, double tolerance,
                   Complex estimate, int depth) const;
  Complex gauss(const ScatteringLaw& law, double from, double to) const;

  double optical_depth_, q_;
  Pair lights_, views_;
  PairWave light_, view_;
};

}  // namespace flatspeckle::mc
