#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "mc/theory/detector_noise.h"
#include "mc/imaging/recovery/deconvolution.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/recovery/line_object.h"

namespace flatspeckle::mc {

/// Prior information on an object for the search.
struct SparseTask {
  std::size_t points = 2;   ///< number of points
  double resolution = 1;    ///< least distance, and least difference of distances, in pixels
  std::size_t beam = 1000;  ///< number of partial objects that are kept
  /// Distance in pixels at which the speckles of two points have the correlation C_I = 1/2; the
  /// search uses it to weight pairs. 0: the speckle of all points is the same. C_I is that of a
  /// diffuse slab, (x / sinh x)^2 with x = 1.491 distance / memory_range (conventions, C20).
  double memory_range = 0;
};

/// Returns C_I of two points at this distance.
double memory_correlation(double distance, double memory_range);

/// The object whose pair distances fit the peaks best: positions in pixels, the first at 0, and
/// brightness with mean 1. explained: agreement of the measured peaks of all pairs with the peaks
/// expected from the brightness. It is the sum of their products, divided by the square root of the
/// product of their sums of squares; 1 for a perfect fit.
struct SparseFit {
  LineObject object;
  double explained = 0;
};

/// Finds an object by beam search: objects grow point by point, and the most likely partial objects
/// are kept. All distances must be distinct (a Golomb ruler); otherwise the autocorrelation of one
/// line does not determine the object. An object and its mirror image count as one. In white
/// Gaussian noise of variance s^2, a pair whose peak has the height h and the expected height a
/// adds (2 h a - a^2) / (2 s^2) to the log likelihood. For equal points with the same speckle, the
/// most likely object is thus the one with the largest sum of heights. For the objects that are
/// kept at the end, the brightness of each point is fitted; its prior is a normal distribution with
/// a standard deviation of a third of the mean. The positions of the best objects are refined to
/// fractions of a step. Returns the most likely object, or an empty one if no object fits into the
/// lags.
SparseFit sparse_search(const PairPeaks& peaks, const SparseTask& task);

/// Keys of the deconvolution by a reference.
struct DeconvolutionKeys {
  std::string method = "wiener";
  DeconvolutionTask task;
};
void add_keys(Keys& keys, DeconvolutionKeys& values);
/// Reads the keys that the method uses.
DeconvolutionTask deconvolution_task(const Keys& keys, const DeconvolutionKeys& values);

/// Adds the key average.
void add_average_key(Keys& keys, std::int64_t& average);

/// Adds the keys photons and read_noise.
void add_camera_keys(Keys& keys, CameraNoise& noise);
void read_camera_keys(const Keys& keys, const CameraNoise& values, CameraNoise& noise);

/// Settings for the recovery of an object from frames: noise of the camera, and the search.
struct RecoveryTask {
  CameraNoise noise;
  std::size_t lags = 0;          ///< longest distance that is searched, in pixels
  std::size_t points = 0;        ///< number of points to find; 0: no search
  double resolution_grains = 1;  ///< least distance of points, in grains
  double memory_range = 0;       ///< SparseTask::memory_range
};

struct Recovered {
  FrameStatistics statistics;
  SparseFit fit;  ///< in pixels
};

/// Recovers an object from several frames, whose autocorrelations are averaged.
Recovered recovered(std::span<const std::vector<double>> frames, const RecoveryTask& task);

}  // namespace flatspeckle::mc
