#pragma once

#include <cstddef>

#include "core/numbers/statistics.h"
#include "core/result/invariant.h"
#include "core/result/result_group.h"
#include "grin/render/sensors/sensor_kind.h"
#include "grin/render/transport/film.h"

namespace flatspeckle::grin {

/// Fractions of the light of a sensor that sound shifts in frequency (TaggingSound).
struct SidebandResult {
  Estimate pixels;      ///< [sideband][pixel]
  Estimate mean;        ///< of all light, [sideband]
  Estimate modulation;  ///< mean of |m|^2 over all light
  /// The sidebands that are not kept contain at most <|m|^2> / 32 of the light, as the squares of n
  /// times the fractions add up to <|m|^2> / 2: by how much the sum of the kept ones misses this.
  Invariant balance;
};

/// Estimates the sidebands of a sensor. first_pixel: its first pixel in the sums.
SidebandResult sideband_result(const SensorPixels& pixels, std::size_t first_pixel,
                               const TimeBins& bins, const GroupedSums& sums);
void write_sidebands(const ResultGroup& group, const SidebandResult& result);

}  // namespace flatspeckle::grin
