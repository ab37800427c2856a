#pragma once

#include <cstddef>
#include <span>

namespace flatspeckle::mc {

/// Probability that a search for so many points finds all of them, from what their pairs' peaks are
/// over the noise of the autocorrelation (peaks_over_noise(); pairs (0, 1), (0, 2), ...), and how
/// many distances it tells apart: the longest over a grain. Nothing in it is fitted.
///
/// The search takes the object with the largest sum of the autocorrelation over its pairs. Let an
/// object have m of its N points elsewhere: all but D = m (2N - m - 1) / 2 of the pairs are the
/// true ones. Those D bring S, the sum of their peaks, and noise of variance D in the true object,
/// and noise of variance D alone in the other. There are K = places^m / m! others (half where m = N
/// - 1, since an object and its mirror image are one), of which the luckiest brings sqrt(D) z, z
/// the median of the largest of K normal numbers. So the truth wins with the probability Phi(S /
/// sqrt(D)
/// - z), for the m points whose pairs bring least; success is the least of these over m = 1 .. N
/// - 1. Where all N points are the same the whole object decides, at peaks of about sqrt(4
/// ln(places) / N).
double predicted_success(std::span<const double> signals, std::size_t points, double places);

}  // namespace flatspeckle::mc
