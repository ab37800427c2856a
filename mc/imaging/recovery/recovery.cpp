#include "mc/imaging/recovery/recovery.h"

namespace flatspeckle::mc {

void add_keys(Keys& keys, DeconvolutionKeys& values) {
  keys.add("deconvolution", values.method, "How frames are divided by the reference")
      .one_of({"wiener", "richardson_lucy"});
  keys.add("regularisation", values.task.regularisation,
           "wiener: power of what is no picture, over that of the reference's speckle")
      .positive();
  keys.add("iterations", values.task.iterations, "richardson_lucy: steps").from(1, 100000);
}

DeconvolutionTask deconvolution_task(const Keys& keys, const DeconvolutionKeys& values) {
  DeconvolutionTask task;
  if (keys.read(values.method) == "wiener") {
    task.regularisation = keys.read(values.task.regularisation);
  } else {
    task.method = DeconvolutionTask::Method::richardson_lucy;
    task.iterations = keys.read(values.task.iterations);
  }
  return task;
}

void add_average_key(Keys& keys, std::int64_t& average) {
  keys.add("average", average,
           "Frames of one object, each through another medium, whose autocorrelations are averaged "
           "before the search")
      .positive();
}

void add_camera_keys(Keys& keys, CameraNoise& noise) {
  keys.add("photons", noise.photons,
           "Of the camera: detected per pixel, mean of the light (default 0: no shot noise)")
      .not_negative();
  keys.add("read_noise", noise.read_noise, "Standard deviation, photons").not_negative();
}

void read_camera_keys(const Keys& keys, const CameraNoise& values, CameraNoise& noise) {
  noise.photons = keys.read(values.photons);
  if (noise.photons > 0) noise.read_noise = keys.read(values.read_noise);
}

Recovered recovered(std::span<const std::vector<double>> frames, const RecoveryTask& task) {
  Recovered found;
  found.statistics = frame_statistics(frames, task.lags, task.noise);
  if (task.points == 0 || found.statistics.grain == 0) return found;
  const double resolution = task.resolution_grains * found.statistics.peaks.width;
  SparseTask search{task.points, resolution};
  search.memory_range = task.memory_range;
  found.fit = sparse_search(found.statistics.peaks, search);
  return found;
}

}  // namespace flatspeckle::mc
