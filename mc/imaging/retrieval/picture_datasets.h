#pragma once

#include <string>
#include <vector>

#include "core/result/result_group.h"
#include "mc/imaging/recovery/phase_retrieval.h"
#include "mc/imaging/retrieval/picture_points.h"
#include "mc/imaging/retrieval/picture_statistics.h"

namespace flatspeckle::mc {

extern const DatasetTable recovered_picture_table;

/// Result of `recover` for one frame, or for several frames of one object.
struct RecoveredPicture {
  PictureStatistics statistics;
  RetrievedPicture retrieved;  ///< without a picture if points were searched
  PicturePoints points;        ///< none unless points were searched
};

/// Writes statistics and pictures of frames; instead of pictures, points if there are any. sought:
/// number of points that were searched.
void write_pictures(ResultFile& file, const std::vector<std::string>& names, std::size_t lags,
                    std::size_t sought, const std::vector<RecoveredPicture>& all);

}  // namespace flatspeckle::mc
