#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "flatland/request/field_moments.h"

namespace flatspeckle::mc {

/// Function that adds the results of batch `number` to `sums`, which are 0 before the call.
using SummedBatches = std::function<void(std::uint64_t number, std::span<Complex> sums)>;

/// Job that estimates the covariance of a scene and further quantities from the same paths, such as
/// derivatives or covariances after delays.
struct PathJob {
  FieldJob field;           ///< the covariance, and the mean field if it has a closed form
  Estimator all;            ///< all quantities, [quantity][entry]; the first is the covariance
  std::size_t entries = 0;  ///< number of entries of the request
};

}  // namespace flatspeckle::mc
