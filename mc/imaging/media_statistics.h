#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "mc/imaging/imaging.h"

namespace flatspeckle::mc {

/// Returns the probability that a search for `points` points finds all of them. signals: the height
/// of the peak of each pair, divided by the noise of the autocorrelation
/// (filtered_peaks_over_noise(); pairs (0, 1), (0, 2), ...). places: number of resolvable
/// distances, which is the longest distance times the band of frequencies. The model has no fitted
/// constants.
///
/// The search selects the object with the largest sum of the autocorrelation over its pairs. An
/// object with m of its N points at wrong positions lacks D = m (2N - m - 1) / 2 of the true pairs.
/// In the true object these D pairs contribute S, the sum of their peaks, and noise of variance D;
/// in the wrong object the D pairs in their place contribute only noise of variance D. As a
/// function of the m positions, the noise is a Gaussian field. Its volume is places^m / m! for each
/// of the C(N, m) choices of wrong points. For m = N - 1 the factor one half replaces C(N, m),
/// because the position of the remaining point is arbitrary and mirrored objects are equal. The
/// noise has the spectrum T^2, where T is a triangle. Along one lag its second spectral moment is q
/// = (2 pi band)^2 / 10. The second moments of the field form the matrix (q / D) (N I - J) of m
/// rows, with the identity I and the matrix J of ones; its determinant is (q / D)^m N^(m-1) (N -
/// m).
///
/// Pairs of the wrong object may coincide at random with peaks of the D true pairs, which are as
/// wide as one resolvable distance. A wrong pair thus gains c = S / places on average. The variance
/// v of this gain is two thirds of the sum of the squared peaks divided by places, less c^2. Let z
/// be the median of the largest maximum of the field, and Phi the normal distribution function. The
/// true object is then selected with the probability
///   Phi((S - D c) / sqrt(D) - z sqrt(1 + v)),
/// where the m points are those whose pairs contribute least. Success is the minimum over m = 1 ..
/// N - 1. If all N points are equal and `places` is large, m = N - 1 is decisive, and the peaks
/// must exceed about sqrt(4 ln(places) / N).
///
/// Two more kinds of wrong objects share peaks with the true one. First, a point k may be mirrored
/// at the centre between two others, i and j. It then keeps its two distances to them, exchanged,
/// and loses S, the sum of the peaks of its other N - 3 pairs. This object is selected with the
/// probability Phi(-S / sqrt(2 (N - 3))). Success is multiplied by exp(-sum of these probabilities
/// over k, i, j), the probability that none of these objects is selected. Second, the line may be
/// cut into two groups, one of which is moved or mirrored as a whole. All pairs across the cut are
/// then lost, and the field is that of a single position. x: positions of the points, which
/// determine the cuts; if it is empty, no cuts are considered.
///
/// weighted: the search weights pairs by the expected heights of their peaks. Then the sum of the
/// squared peaks replaces S, the sum of the peaks replaces D in D c, and the root of the sum of the
/// squared peaks replaces sqrt(D).
double predicted_success(std::span<const double> signals, std::size_t points, double places,
                         bool weighted = false, std::span<const double> x = {});

/// A mean over random media, and its standard error.
struct MeanOverMedia {
  double value = 0, error = 0;
};

/// Returns the mean of a quantity over the media. of: returns the quantity for one medium.
/// error_of_one: the standard error to return if there is only one medium.
MeanOverMedia mean_over(const std::vector<ImagedMedium>& media, double error_of_one,
                        const std::function<double(const ImagedMedium&)>& of);

/// Returns the fraction of media for which a condition holds. The error is the standard deviation
/// of the posterior (Beta distribution with a uniform prior). It is not 0 even if the condition
/// holds for all media.
MeanOverMedia share_of(const std::vector<ImagedMedium>& media,
                       const std::function<bool(const ImagedMedium&)>& holds);
/// Returns the same fraction for `found` of n media.
MeanOverMedia share_of(double found, double n);

/// Returns the square root of a mean, or 0 if the mean is negative.
MeanOverMedia root_of(const MeanOverMedia& square);

/// Returns the number of grains per frame, averaged over all media.
double mean_grains(const std::vector<ImagedMedium>& media);

/// Returns the expected statistics of the frames of one repeat, for Gaussian speckle from the whole
/// width of the box.
FrameGrains frame_grains(const LineScene& line, const ImagingTask& task);

/// Returns the contrast of the Gaussian speckle of an object of brightness b: sqrt(sum of b^2) /
/// (sum of b) / (1 + background). For N equal points without background it is 1/sqrt(N).
double gaussian_contrast(const LineObject& object, double background);

/// Returns the root mean square of the contrast over the media. For a single medium the error is
/// that of Gaussian speckle, whose squared contrast has the variance (2 kappa_2^2 + kappa_4) /
/// grains. For a brightness b with sum 1, kappa_2 is the sum of b^2, and kappa_4 is 6 times the sum
/// of b^4.
MeanOverMedia mean_contrast(const LineObject& object, const std::vector<ImagedMedium>& media);

/// Returns E|u|^4 / (E|u|^2)^2 of the fields of the points, which is 2 for Gaussian fields. For a
/// single medium the error is that of the Gaussian speckle of one point.
MeanOverMedia mean_fourth_moment(const std::vector<ImagedMedium>& media);

/// Returns the fraction of media in which all points were found.
MeanOverMedia success_rate(const std::vector<ImagedMedium>& media);

/// Predicted peaks in the autocorrelation of a repeat, computed without frames.
struct ExpectedPeaks {
  std::vector<double> signals;  ///< peaks_over_noise()
  /// Result of predicted_success(); empty if the search is for another number of points.
  std::optional<double> success;
};
ExpectedPeaks expected_peaks(const LineScene& line, const ImagingTask& task,
                             const ImagingPrediction& prediction);

/// Returns the number of pairs of points whose distance is within `grains` grains of the distance
/// of another pair. If there are such pairs, a search that requires distinct distances does not
/// find all points.
std::size_t alike_pairs(const LineScene& line, double grains);

/// Returns the peak signal-to-noise ratio of the deconvolved pictures, averaged over the media, in
/// dB.
MeanOverMedia mean_psnr(const std::vector<ImagedMedium>& media);

}  // namespace flatspeckle::mc
