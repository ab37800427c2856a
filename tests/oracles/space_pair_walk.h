#pragma once

#include <complex>
#include <cstdint>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::oracles {

/// Covariance of scalar waves in a 3D slab (conventions, C41) by textbook Monte Carlo. Photons of a
/// pair of illuminations walk through Henyey-Greenstein scatterers. They carry the phase of the
/// transverse momentum and of the wavenumber difference, and at each scattering add their
/// contribution to a pair of detection directions. Lengths are in mean free paths; the first
/// illumination comes from above.
struct SpacePairWalk {
  double k, depth, g, albedo;
  grin::Vec3 light1, light2, view1, view2;
  /// Relative shift of the second field's wavenumber; view2 must be the matched direction.
  double shift = 0;

  struct Estimate {
    std::complex<double> value;
    double error;  ///< standard error, the same for real and imaginary part
  };
  /// single: whether to include single scattering; true for the ladder, false for reversed paths,
  /// which have none.
  Estimate estimate(std::uint64_t photons, std::uint64_t seed, bool single) const;
};

}  // namespace flatspeckle::oracles
