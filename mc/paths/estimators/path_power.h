#pragma once

#include <cstdint>
#include <memory>

#include "core/result/invariant.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// Result of a check that the paths of a scene carry the power that a plane wave loses in the
/// medium. The power of a path is divided by the power that the medium takes from the incident ray
/// on which the path begins; the quotient has little variance. The members are deviations from
/// expected values, with limits of 1e-3 plus five standard errors.
struct PathPower {
  /// Paths of one scatterer: power that reaches the scatterer, divided by the power that the
  /// incident ray through it loses in the medium. Expected value: 1.
  Invariant first;
  /// Paths of two scatterers: the same ratio for the second scatterer, divided by the probability
  /// that the flight from the first scatterer ends in the medium. Expected value: 1.
  Invariant second;
  /// Power that reaches the third and later scatterers, minus the power that the second and later
  /// scatterers scatter and that does not leave the medium. Expected value: 0. Computed only in 2D.
  /// The sampling error is about 0.5 / sqrt(paths).
  Invariant later;
};

/// Makes walks, like those for covariances and fields, from the first plane wave of a scene, with
/// views in all directions. Returns null if there is no plane wave, nothing scatters, a material
/// only absorbs, or rays are curved.
std::shared_ptr<const PathWalks> power_walks(const Scene& scene, std::uint64_t seed);

/// Samples at least the given number of paths and checks them. With 20000 paths the errors of
/// `first` and `second` are about 1e-3.
PathPower path_power(const std::shared_ptr<const PathWalks>& walks, std::uint64_t paths);

}  // namespace flatspeckle::mc
