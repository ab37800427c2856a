#pragma once

#include <cstddef>
#include <span>

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

}  // namespace flatspeckle::mc
