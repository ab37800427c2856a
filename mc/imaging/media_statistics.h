#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "mc/imaging/imaging.h"

namespace flatspeckle::mc {

/// Probability that a search for so many points finds all of them, from what their pairs' peaks are
/// over the noise of the autocorrelation (filtered_peaks_over_noise(); pairs (0, 1), (0, 2), ...),
/// and how many distances it tells apart: the longest times the band of frequencies. Nothing in it
/// is fitted.
///
/// The search takes the object with the largest sum of the autocorrelation over its pairs. Let an
/// object have m of its N points elsewhere: all but D = m (2N - m - 1) / 2 of the pairs are the
/// true ones. Those D bring S, the sum of their peaks, and noise of variance D in the true object,
/// and noise of variance D alone in the other. The others are a Gaussian field over the m places,
/// places^m / m! of them for each of C(N, m) choices (for m = N - 1 one half: wherever the one
/// point is, and mirrored, the object is the same). The noise has the spectrum of the squared
/// triangle, T^2, so that a lag has the second moment q = (2 pi band)^2 / 10, the field that of the
/// matrix (q / D) (N - J) of m rows, J of ones, whose determinant is (q / D)^m N^(m-1) (N - m).
/// Pairs of the other object meet peaks of those D true ones by chance, which are as wide as a
/// place: each has c = S / places in the mean, with a variance v that is two thirds of the sum of
/// the peaks' squares over the places, less c^2. With z the median of the field's largest maximum
/// the truth wins with the probability
///   Phi((S - D c) / sqrt(D) - z sqrt(1 + v)),
/// for the m points whose pairs bring least; success is the least of these over m = 1 .. N - 1.
/// Where all N points are the same and places many, the whole object decides, at peaks of about
/// sqrt(4 ln(places) / N).
///
/// Two more kinds of objects have peaks of the true one. A point k that is mirrored at the middle
/// of two others, i and j, keeps its distances to them (exchanged) and loses S of the other N - 3
/// pairs: it wins with the probability Phi(-S / sqrt(2 (N - 3))), and success has the factor
/// exp(-sum over k, i, j) of none winning. And where a cut divides the line in two groups, one of
/// them may move or be mirrored as a whole: all pairs across it are lost, and the field is that of
/// one place. x, the points' places, tells the cuts; none without it.
///
/// weighted: the search knows how high each peak is, and weighs pairs by that: with the peaks'
/// squares for S, and their sum for D in D c, over the root of the sum of squares.
double predicted_success(std::span<const double> signals, std::size_t points, double places,
                         bool weighted = false, std::span<const double> x = {});

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
