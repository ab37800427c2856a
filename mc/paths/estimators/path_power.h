#pragma once

#include <cstdint>
#include <memory>

#include "core/result/invariant.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// Whether the paths of a scene carry the power that a plane wave loses, over that power: along
/// each of its rays, which leaves little variance. Limits are 1e-3 and five standard errors.
struct PathPower {
  Invariant first;   ///< what first scatterers receive of what a ray loses, by paths of one
  Invariant second;  ///< the same by paths of two, over the probability of their flights
  /// In the plane: what later scatterers receive, less what neither leaves the medium from those
  /// before nor is absorbed there. Sampling adds about 0.5 / sqrt(paths) to it.
  Invariant later;
};

/// Walks from the first plane wave of a scene, as covariances and fields are made of, with views
/// all around. Null where there is no plane wave, nothing scatters, a material absorbs all, or rays
/// bend.
std::shared_ptr<const PathWalks> power_walks(const Scene& scene, std::uint64_t seed);

/// By so many paths of these walks; 20000 determine `first` and `second` to about a thousandth.
PathPower path_power(const std::shared_ptr<const PathWalks>& walks, std::uint64_t paths);

}  // namespace flatspeckle::mc
