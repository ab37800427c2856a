#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "mc/imaging/recovery/camera_noise.h"
#include "mc/imaging/recovery/deconvolution.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// What is known of an object before the search.
struct SparseTask {
  std::size_t points = 2;   ///< how many there are
  double resolution = 1;    ///< pixels: nothing is nearer than this: of points, and of distances
  std::size_t beam = 1000;  ///< partial objects that are kept
  /// Distance in pixels at which the speckles of two points have the correlation C_I = 1/2, where
  /// the search is to know it; 0: all points share theirs. C_I is that of a diffuse slab,
  /// (x / sinh x)^2 with x = 1.491 distance / memory_range (conventions, C20).
  double memory_range = 0;
};

/// C_I of two points.
double memory_correlation(double distance, double memory_range);

/// Positions in pixels, the first at 0, of the points whose distances fit the peaks best;
/// brightness with a mean of 1. explained: sum over the pairs of the peak at their distance times
/// what the brightness would give, over the square root of the sum of squares of either; 1 for a
/// perfect fit.
struct SparseFit {
  LineObject object;
  double explained = 0;
};

/// A beam search: objects grow point by point, and those are kept whose pairs are the most likely;
/// all distances must be distinct (a Golomb ruler), without which one line does not tell objects
/// apart. An object and its mirror image are one. In white Gaussian noise of variance s^2 a pair of
/// height h at a place where a is expected adds (2 h a - a^2) / (2 s^2) to the logarithm of the
/// likelihood: for points that are equal and share their speckle that is the sum of the heights. Of
/// the last that are kept, the most likely with a brightness of each point, whose prior is a normal
/// distribution with a standard deviation of a third of its mean, and places between the steps.
/// Nothing where none fits into the lags.
SparseFit sparse_search(const PairPeaks& peaks, const SparseTask& task);

/// How frames are divided by a reference, as keys have it.
struct DeconvolutionKeys {
  std::string method = "wiener";
  DeconvolutionTask task;
};
void add_keys(Keys& keys, DeconvolutionKeys& values);
/// Reads what the method has use for.
DeconvolutionTask deconvolution_task(const Keys& keys, const DeconvolutionKeys& values);

/// average
void add_average_key(Keys& keys, std::int64_t& average);

/// photons and read_noise.
void add_camera_keys(Keys& keys, CameraNoise& noise);
void read_camera_keys(const Keys& keys, const CameraNoise& values, CameraNoise& noise);

/// What is looked for in a frame, and what is known of its camera.
struct RecoveryTask {
  CameraNoise noise;
  std::size_t lags = 0;          ///< pixels: longer distances are not looked for
  std::size_t points = 0;        ///< that are looked for; 0: none
  double resolution_grains = 1;  ///< least distance of points
  double memory_range = 0;       ///< as that of SparseTask
};

struct Recovered {
  FrameStatistics statistics;
  SparseFit fit;  ///< in pixels
};

/// Of frames of one object, whose autocorrelations are averaged.
Recovered recovered(std::span<const std::vector<double>> frames, const RecoveryTask& task);

}  // namespace flatspeckle::mc
