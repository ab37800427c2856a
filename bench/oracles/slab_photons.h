#pragma once

#include <cstdint>

namespace flatspeckle::oracles {

/// A plain photon program as tissue optics has it (MCML: Wang, Jacques and Zheng 1995), made for
/// one infinite slab of matched index and nothing else: light along the normal, absorption by
/// weight, roulette of light weights, Henyey-Greenstein. Depths in mean free paths. What `render`
/// is timed against.
struct SlabPhotons {
  double optical_depth, albedo, g;
};

struct CountedShares {
  double reflected = 0, transmitted = 0;  ///< per photon; unscattered light included
  double reflected_error = 0, transmitted_error = 0;
};

CountedShares count_photons(const SlabPhotons& slab, std::uint64_t photons, std::uint64_t seed);

}  // namespace flatspeckle::oracles
