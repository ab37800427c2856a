#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "mc/imaging/imaging.h"

namespace flatspeckle::mc {

extern const DatasetTable picture_table;

/// PSNR in dB that a picture by Wiener's filter is expected to have, without one, of a scene with a
/// reference.
double expected_psnr(const LineScene& line, const ImagingTask& task,
                     const ImagingPrediction& prediction);

/// Pictures of frames that were divided by a reference, beside what write_imaging() has written.
void write_pictures(ResultFile& file, const LineScene& line, const ImagingTask& task,
                    const std::vector<ImagedMedium>& media, const ImagingPrediction& prediction);

extern const DatasetTable imaging_table;

void write_imaging(ResultFile& file, const LineScene& line, const ImagingTask& task,
                   const std::vector<ImagedMedium>& media, const ImagingPrediction& prediction);

}  // namespace flatspeckle::mc
