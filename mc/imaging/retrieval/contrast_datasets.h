#pragma once

#include <optional>

#include "core/result/result_group.h"
#include "mc/imaging/retrieval/contrast_map.h"

namespace flatspeckle::mc {

extern const DatasetTable contrast_map_table;

/// Exposure of the frames, and squared contrast of static scatterers, for decay rates.
struct ExposureOfFrames {
  double exposure = 0, beta = 1;
};

/// Writes a map, for windows of `window` pixels. Decay rates are written if the exposure is known.
void write_contrast(ResultFile& file, const ContrastMap& map, std::size_t window,
                    const std::optional<ExposureOfFrames>& exposure);

}  // namespace flatspeckle::mc
