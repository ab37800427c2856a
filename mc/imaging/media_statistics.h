#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "mc/imaging/imaging.h"

namespace flatspeckle::mc {

/// A number that chance has made, and its standard error.
struct MeanOverMedia {
  double value = 0, error = 0;
};

/// of: a number of each medium. error_of_one: where there is but one.
MeanOverMedia mean_over(const std::vector<ImagedMedium>& media, double error_of_one,
                        const std::function<double(const ImagedMedium&)>& of);

/// Of media for which something holds. The error is the standard deviation of what so many trials
/// leave open, which is not 0 where all succeed (Beta distribution with a uniform prior).
MeanOverMedia share_of(const std::vector<ImagedMedium>& media,
                       const std::function<bool(const ImagedMedium&)>& holds);

/// Its root, 0 where it is negative.
MeanOverMedia root_of(const MeanOverMedia& square);

/// Grains of a frame, averaged over all media.
double mean_grains(const std::vector<ImagedMedium>& media);

/// Of the frames of one repeat, as Gaussian speckle of the whole box is expected to have them.
FrameGrains frame_grains(const LineScene& line, const ImagingTask& task);

/// Contrast of an object's Gaussian speckle: sqrt(sum of b^2) / sum of b, 1/sqrt(N) for N equal
/// points; less by 1 + background.
double gaussian_contrast(const LineObject& object, double background);

/// The root of the mean square of the media's contrast. Of one medium the error is that of Gaussian
/// speckle: its squared contrast has the variance (2 kappa_2^2 + kappa_4) / grains, kappa_2 = sum
/// of b^2 and kappa_4 = 6 sum of b^4, where the sum of b is 1.
MeanOverMedia mean_contrast(const LineObject& object, const std::vector<ImagedMedium>& media);

/// E|u|^4 / (E|u|^2)^2 of the points' fields: Gaussian, 2. Of one medium the error is that of one
/// point's Gaussian speckle.
MeanOverMedia mean_fourth_moment(const std::vector<ImagedMedium>& media);

/// Of media in which all points were found.
MeanOverMedia success_rate(const std::vector<ImagedMedium>& media);

/// What a frame of a repeat should show without being made.
struct ExpectedPeaks {
  std::vector<double> signals;    ///< as peaks_over_noise()
  std::optional<double> success;  ///< as predicted_success(), where so many points are looked for
};
ExpectedPeaks expected_peaks(const LineScene& line, const ImagingTask& task,
                             const ImagingPrediction& prediction);

/// Pairs of points as far apart, within so many grains, as another pair: a search that wants
/// distances to be distinct is not to find all of them.
std::size_t alike_pairs(const LineScene& line, double grains);

/// dB.
MeanOverMedia mean_psnr(const std::vector<ImagedMedium>& media);

}  // namespace flatspeckle::mc
