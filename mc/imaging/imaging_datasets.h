#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "mc/imaging/imaging.h"
#include "mc/imaging/media_statistics.h"

namespace flatspeckle::mc {

extern const DatasetTable blinking_table;

/// Contrast of single frames: root of the mean square over the media, and what Gaussian speckle of
/// the brightness that was drawn should have.
struct FrameContrast {
  MeanOverMedia found;
  double expected = 0;
};
FrameContrast frame_contrast(const std::vector<ImagedMedium>& media);

/// Of media whose frames show all points as sources, as success_rate().
MeanOverMedia sources_success(const std::vector<ImagedMedium>& media);

/// Frames in which points blink, beside what write_imaging() has written.
void write_blinking(ResultFile& file, const LineScene& line, const ImagingTask& task,
                    const std::vector<ImagedMedium>& media);

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
