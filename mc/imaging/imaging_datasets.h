#pragma once

#include <vector>

#include "core/result/dataset_row.h"
#include "mc/imaging/imaging.h"
#include "mc/imaging/media_statistics.h"

namespace flatspeckle::mc {

extern const DatasetTable blinking_table;

/// Contrast of single frames: the root mean square over the media, and the value expected for
/// Gaussian speckle with the drawn brightness of the points.
struct FrameContrast {
  MeanOverMedia found;
  double expected = 0;
};
FrameContrast frame_contrast(const std::vector<ImagedMedium>& media);

/// Returns the fraction of media in which all points are found as sources. The error is estimated
/// as in success_rate().
MeanOverMedia sources_success(const std::vector<ImagedMedium>& media);

/// Writes frames in which points blink, in addition to the output of write_imaging().
void write_blinking(ResultFile& file, const LineScene& line, const ImagingTask& task,
                    const std::vector<ImagedMedium>& media);

extern const DatasetTable picture_table;

/// Returns the peak signal-to-noise ratio, in dB, that is expected for a picture deconvolved with
/// the Wiener filter. The scene must have a reference; no frames are simulated.
double expected_psnr(const LineScene& line, const ImagingTask& task,
                     const ImagingPrediction& prediction);

/// Writes pictures from frames deconvolved by a reference, in addition to the output of
/// write_imaging().
void write_pictures(ResultFile& file, const LineScene& line, const ImagingTask& task,
                    const std::vector<ImagedMedium>& media, const ImagingPrediction& prediction);

extern const DatasetTable imaging_table;

void write_imaging(ResultFile& file, const LineScene& line, const ImagingTask& task,
                   const std::vector<ImagedMedium>& media, const ImagingPrediction& prediction);

}  // namespace flatspeckle::mc
