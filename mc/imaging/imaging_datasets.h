#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "mc/imaging/imaging.h"

namespace flatspeckle {
class ResultFile;
}

namespace flatspeckle::mc {

extern const DatasetTable imaging_table;

/// A share of so many trials, and the standard deviation of what they leave open, which is not 0
/// where all succeed (Beta distribution with a uniform prior).
struct SuccessRate {
  double value = 0, error = 0;
};
/// Of frames in which all points were found.
SuccessRate success_rate(const std::vector<ImagedMedium>& media);

void write_imaging(ResultFile& file, const LineScene& line, const ImagingTask& task,
                   const std::vector<ImagedMedium>& media, const ImagingPrediction& prediction);

}  // namespace flatspeckle::mc
