#pragma once

#include <cstddef>
#include <span>

#include "mc/recovery/line_object.h"

namespace flatspeckle::mc {

/// What is known of an object before the search.
struct SparseTask {
  std::size_t points = 2;   ///< how many there are
  double resolution = 1;    ///< nothing is nearer than this: of points, and of distances of pairs
  std::size_t beam = 1000;  ///< partial objects that are kept
};

/// Positions in pixels, the first at 0, of the points whose distances fit an autocorrelation (by
/// lag in pixels) best; brightness with a mean of 1. explained: sum over the pairs of the
/// autocorrelation at their distance times what the brightness would give, over the square root of
/// the sum of squares of either; 1 for a perfect fit.
struct SparseFit {
  LineObject object;
  double explained = 0;
};

/// A beam search: objects grow point by point, and those are kept whose pairs' distances have the
/// largest sum of the autocorrelation; all distances must be distinct (a Golomb ruler), without
/// which one line does not tell objects apart. An object and its mirror image are one. Of the last
/// that are kept the one with the best explained pairs. Nothing where none fits into the lags.
SparseFit sparse_search(std::span<const double> autocorrelation, const SparseTask& task);

}  // namespace flatspeckle::mc
