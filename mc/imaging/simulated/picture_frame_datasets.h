#pragma once

#include <vector>

#include "core/result/result_group.h"
#include "mc/imaging/media_statistics.h"
#include "mc/imaging/simulated/picture_frames.h"
#include "mc/imaging/simulated/picture_prediction.h"

namespace flatspeckle::mc {

extern const DatasetTable simulated_picture_table;

/// Result of `image` in space.
struct PictureResult {
  SpecklePrediction speckle;
  std::vector<double> truth;
  std::vector<SimulatedPicture> pictures;
  PicturePrediction prediction;  ///< if task.draws > 0

  /// Returns the fraction of the pictures whose recovery is a success, and its error (share_of()).
  MeanOverMedia success(double least_similarity) const;
};

void write_simulated(ResultFile& file, const PictureScene& scene, const PictureTask& task,
                     const PictureResult& result);

}  // namespace flatspeckle::mc
