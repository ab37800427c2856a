#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// A relative difference that must be 0, its standard error, and what chance may make of it.
struct PowerBalance {
  double off = 0, error = 0;

  double limit() const { return 1e-3 + 5 * error; }
};

/// Whether the paths of a scene carry the power that a plane wave loses, over that power.
struct PathPower {
  PowerBalance first;   ///< what the first scatterers receive, by paths of one: 1 - direct light
  PowerBalance second;  ///< the same by paths of two, over the probability of their flights
  /// In the plane: what later scatterers receive, less what neither leaves the medium from those
  /// before nor is absorbed there. Chance adds about 0.5 / sqrt(paths) to it.
  PowerBalance later;
};

/// Walks from the first plane wave of a scene, as covariances and fields are made of, with views
/// all around. Null where there is no plane wave, nothing scatters, a material absorbs all, or rays
/// bend.
std::shared_ptr<const PathWalks> power_walks(const Scene& scene, std::uint64_t seed);

/// By so many paths of these walks, 20000 of which know `first` and `second` to about a thousandth.
/// Nothing where a signal came.
std::optional<PathPower> path_power(const std::shared_ptr<const PathWalks>& walks,
                                    std::uint64_t paths, int threads);

}  // namespace flatspeckle::mc
