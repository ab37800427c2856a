#pragma once

#include <string>

#include "core/keys/keys.h"
#include "mc/imaging/recovery/camera_noise.h"
#include "mc/imaging/recovery/deconvolution.h"

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

}  // namespace flatspeckle::mc
