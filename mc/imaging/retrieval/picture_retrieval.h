#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mc/imaging/recovery/phase_retrieval.h"

namespace flatspeckle::mc {

/// A positive object in a plane, blurred by a speckle grain. Its position is arbitrary, and it may
/// be rotated by 180 degrees.
struct RetrievedPicture {
  std::vector<double> picture;  ///< [y][x], `lags` pixels in both directions; the sum is 1
  /// At each iteration: rms of those values of the estimate that are negative or beyond the lags,
  /// divided by the rms of the whole estimate.
  std::vector<double> residual;
  /// Mean correlation (best_correlation()) between this picture and those of the better half of the
  /// other starts, by their residual: confidence in the picture; 1 with a single start.
  double agreement = 1;
};

/// Retrieves an object from its autocorrelation, by hybrid input-output and error reduction from
/// several random starts [fienup1982]. autocorrelation: at lags from -(lags - 1) to lags - 1,
/// [y][x]. The object must be smaller than `lags` pixels. Returns the picture of smallest residual.
RetrievedPicture retrieved_picture(std::span<const double> autocorrelation, std::size_t lags,
                                   const PhaseTask& task);

/// Returns the normalised sum of products of two pictures of `side` x `side` pixels at the best
/// shift, rotated by 180 degrees or not; 1 if they are proportional.
double best_correlation(std::span<const double> a, std::span<const double> b, std::size_t side);

}  // namespace flatspeckle::mc
