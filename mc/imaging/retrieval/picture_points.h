#pragma once

#include <cstddef>
#include <vector>

#include "mc/imaging/retrieval/picture_statistics.h"

namespace flatspeckle::mc {

/// Points of an object in a picture, by increasing x: places in pixels from the first, and
/// brightness with mean 1. explained: as in SparseFit.
struct PicturePoints {
  std::vector<double> x, y, brightness;
  double explained = 0;
};

/// Finds points from the peaks of their pairs in the autocorrelation of pictures. statistics: have
/// this number of lags. resolution: least distance of points, and of distances between them, in
/// pixels. The highest peak belongs to the first two points. A beam search adds points at places
/// where the autocorrelation has a maximum, and keeps the objects whose pairs have the largest sum
/// of heights. All distances must differ as vectors. The brightness is fitted as in
/// sparse_search(), and the places are those that fit the maxima of all pairs best. The object may
/// be rotated by 180 degrees. Returns no points if the autocorrelation has too few maxima.
PicturePoints picture_points(const PictureStatistics& statistics, std::size_t lags,
                             std::size_t points, double resolution);

}  // namespace flatspeckle::mc
