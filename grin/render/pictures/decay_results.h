#pragma once

#include <cstddef>

#include "core/numbers/statistics.h"
#include "core/result/result_group.h"
#include "grin/render/sensors/sensor_kind.h"
#include "grin/render/transport/film.h"

namespace flatspeckle::grin {

/// Field correlation of the light of a sensor after delays (FieldDecay).
struct DecayResult {
  Estimate pixels;    ///< g1, [delay][pixel]
  Estimate mean;      ///< g1 of all light, [delay]
  Estimate bins;      ///< g1 of the light in each bin of optical path, [delay][bin]; may be empty
  Estimate transfer;  ///< mean momentum transfer of all light, [part]
  Estimate gradient;  ///< derivatives of `mean` by the diffusion of each part, [part][delay]
};

/// Estimates the field correlation of a sensor. first_pixel: its first pixel in the sums.
DecayResult decay_result(const SensorPixels& pixels, std::size_t first_pixel, const TimeBins& bins,
                         const GroupedSums& sums);
void write_decay(const ResultGroup& group, const DecayResult& result);

}  // namespace flatspeckle::grin
