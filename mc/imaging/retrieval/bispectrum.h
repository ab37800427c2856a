#pragma once

#include <cstddef>
#include <vector>

#include "core/frames/frames.h"
#include "mc/imaging/recovery/phase_retrieval.h"
#include "mc/imaging/retrieval/picture_statistics.h"

namespace flatspeckle::mc {

/// Returns a picture from the bispectrum of frames of one object [lohmann1983], [wu2016]. Frames
/// divided by their envelope are cut into overlapping windows. The mean over the windows of F(f)
/// F(b) conj(F(f + b)), for their spectra F, has the phase phi(f) + phi(b) - phi(f + b) of the
/// object's spectrum, because the mean bispectrum of speckle is real and positive. The phases
/// follow from those at lower frequencies. Unlike an autocorrelation, they determine the
/// orientation. The picture has lags x lags pixels, [y][x]; its position is arbitrary.
std::vector<double> bispectrum_picture(const Frames& frames, std::size_t first, std::size_t count,
                                       std::size_t lags);

/// Returns the picture of bispectrum_picture() after error reduction, by which it takes the
/// autocorrelation of the frames; it keeps its orientation.
RetrievedPicture oriented_picture(const Frames& frames, std::size_t first, std::size_t count,
                                  const PictureStatistics& statistics, std::size_t lags,
                                  const PhaseTask& task);

}  // namespace flatspeckle::mc
