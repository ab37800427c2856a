#pragma once

#include <cstdint>
#include <vector>

namespace flatspeckle::oracles {

/// A layer of Henyey-Greenstein scatterers. diffusion: factor on the diffusion constant.
struct WalkLayer {
  double mu_a, mu_s, g, thickness, diffusion = 1;
};

/// Photon walk through layers of one index from a beam along the normal: free flights and turns are
/// drawn from their distributions, and the surface reflects at random. Photons are split and
/// undergo Russian roulette by their distance from the beam, and their weights account for
/// absorption.
struct LayeredWalk {
  std::vector<WalkLayer> layers;
  double index;                   ///< of the layers, relative to that above
  std::vector<double> distances;  ///< middles of rings around the beam, on the surface
  double width;                   ///< of the rings
  std::vector<double> delays;     ///< k^2 D tau
  double growth = 0.2;  ///< growth per length of the importance by which photons are split

  /// Light that leaves through a ring, as a fraction of the light that entered: sums over photons
  /// of w exp(-2 sum delay (1 - cos)), [1 + delay], the first without delay; and standard errors.
  struct Ring {
    std::vector<double> value, error;
  };
  /// Traces `batches` batches of 1000 photons.
  std::vector<Ring> trace(int batches, std::uint64_t seed) const;
};

}  // namespace flatspeckle::oracles
