#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "flatland/request/field_moments.h"

namespace flatspeckle::mc {

/// Adds batch `number` to zeroed sums.
using SummedBatches = std::function<void(std::uint64_t number, std::span<Complex> sums)>;

/// What estimates a scene's covariance, and whatever else depends on the same paths: their
/// derivatives, their decay in time.
struct PathJob {
  FieldJob field;           ///< the covariance, and the mean field where that has a closed form
  Estimator all;            ///< [quantity][entry] of all paths
  std::size_t entries = 0;  ///< of the request
};

}  // namespace flatspeckle::mc
