#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/keys/keys.h"
#include "mc/imaging/recovery/camera_noise.h"
#include "mc/imaging/recovery/deconvolution.h"
#include "mc/imaging/recovery/frame_statistics.h"
#include "mc/imaging/recovery/sparse_search.h"

namespace flatspeckle::mc {

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
