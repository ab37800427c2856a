#pragma once

#include <functional>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// Shares of one light as the sums of a FluxJob, what is absorbed left out.
struct FluxSolution {
  std::vector<Complex> shares;
  int ordinates;
};
/// Of a light's angle, with panels of so many nodes.
using FluxSolver = std::function<FluxSolution(double light, int order)>;

/// Shares of each light of a slab, refined from panels of first_order nodes on. The tolerance is
/// relative to reflectance and transmittance.
Refined refined_flux(const Scene& slab, const Refinement& refinement, int first_order,
                     const FluxSolver& solve);

/// The same where nothing scatters.
Refined flux_of_absorber(const Scene& slab, std::size_t angle_bins);

}  // namespace flatspeckle::mc
