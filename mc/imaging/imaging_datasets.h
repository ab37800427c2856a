#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "mc/imaging/imaging.h"

namespace flatspeckle {
class ResultFile;
}

namespace flatspeckle::mc {

extern const DatasetTable imaging_table;

void write_imaging(ResultFile& file, const LineScene& line, const ImagingTask& task,
                   const std::vector<ImagedMedium>& media, const ImagingPrediction& prediction);

}  // namespace flatspeckle::mc
