#pragma once

#include <complex>
#include <cstdint>

#include "grin/media/geometry/vec3.h"

namespace flatspeckle::oracles {

/// The covariance of scalar waves on a slab in space (conventions, C41) by the textbook's Monte
/// Carlo: photons of a pair of lights walk through Henyey-Greenstein scatterers, carry the phase of
/// the transverse momentum and of the difference in wavenumber, and at each scattering add what a
/// pair of views would see of it. Lengths in mean free paths; the first light comes from above.
struct SpacePairWalk {
  double k, depth, g, albedo;
  grin::Vec3 light1, light2, view1, view2;
  double shift = 0;  ///< of the wavenumber of the second field, relative; view2 matched

  struct Estimate {
    std::complex<double> value;
    double error;  ///< of either part
  };
  /// single: with paths of one scattering (the ladder); reversed paths have none.
  Estimate estimate(std::uint64_t photons, std::uint64_t seed, bool single) const;
};

}  // namespace flatspeckle::oracles
