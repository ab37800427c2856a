#pragma once

#include <vector>

#include "mc/transport/angular_grid.h"
#include "mc/transport/pair_wave.h"
#include "mc/transport/scattering_law.h"

namespace flatspeckle::mc {

/// Paths of two scatterings and more that add to an entry: a pair of lights, what it scatters into,
/// and a pair of views that collects it.
struct Chain {
  Pair lights, views;
  std::size_t entry;
};

/// Chains of one transverse frequency on one angular grid: pairs once, chains by their numbers.
struct ChainGroup {
  double q;  ///< per mu_t
  std::vector<Focus> foci;
  std::vector<Pair> lights, views;
  struct Link {
    Eigen::Index light, view;
    std::size_t entry;
  };
  std::vector<Link> links;
};

/// Of two lights, where a phase function changes within an angle of `width`; none if that is wide.
std::vector<Focus> light_foci(Pair lights, double width);

/// Ladders of all entries, and with `reversed` their reversed paths (C38); second views matched.
std::vector<Chain> chains(const CovarianceRequest& request, bool reversed, double shift = 0);

std::vector<ChainGroup> grouped(const Scene& scene, const ScatteringLaw& law,
                                const std::vector<Chain>& chains, double shift = 0);

}  // namespace flatspeckle::mc
