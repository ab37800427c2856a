#include <algorithm>
#include <cstdio>
#include <string>

#include "apps/command/subcommands.h"
#include "core/error.h"
#include "core/frames/frame_corrections.h"
#include "core/frames/frames.h"
#include "core/session/session.h"
#include "mc/imaging/retrieval/contrast_datasets.h"

namespace flatspeckle::apps {

namespace {

/// Values of the keys of the subcommand `contrast`.
struct ContrastKeys {
  std::vector<std::string> frames{};
  std::string over = "space";
  FrameFormat format;
  FrameCorrections corrections;
  std::int64_t window = 7;
  double counts_per_photon = 0, read_noise = 0, beta = 1;
  std::optional<double> exposure;
  RunSettings run;
};

void add_keys(Keys& keys, ContrastKeys& values) {
  keys.add("frames", values.frames,
           "Frames of a camera: one file or several, PNG, TIFF, NPY, PFM, HDF5 or CSV")
      .file();
  add_frame_keys(keys, values.format);
  add_correction_keys(keys, values.corrections);
  keys.add("contrast_over", values.over,
           "space: variance of neighbouring pixels, averaged over the frames; time: variance of "
           "each pixel over frames that are independent of each other")
      .one_of({"space", "time"});
  keys.add("window", values.window, "Side of the square of pixels about each pixel of the map")
      .from(1, 1001);
  keys.add(
          "counts_per_photon", values.counts_per_photon,
          "Counts of the camera per detected photon, for the subtraction of shot noise (default 0: "
          "none)")
      .not_negative();
  keys.add("read_noise", values.read_noise, "Standard deviation of the read noise, in counts")
      .not_negative();
  keys.add("exposure", values.exposure,
           "Exposure of each frame; decay rates per unit of it are then also written. A number "
           "alone "
           "may be in any unit of time; with a unit, rates are per second")
      .positive()
      .unit("s");
  keys.add("beta", values.beta, "Squared contrast of static scatterers (coherence factor)")
      .positive_to(1)
      .only_of("maps with exposure");
  add_output_key(keys, values.run);
}

mc::ContrastTask task_of(const Keys& keys, const ContrastKeys& values, const Frames& frames) {
  mc::ContrastTask task;
  if (keys.read(values.over) == "time") task.over = mc::ContrastTask::Over::time;
  const bool over_time = task.over == mc::ContrastTask::Over::time;
  const auto window = keys.read(values.window);
  if (window < (over_time ? 1 : 2))
    throw InputError("window", window, "must be at least 2 for the contrast over space");
  task.window = static_cast<std::size_t>(window);
  constexpr std::size_t windows = 4;
  if (windows * task.window > std::min(frames.rows, frames.columns))
    throw InputError("window", window,
                     "must be at most a quarter of the frames of " + values.frames.front() +
                         ", which have " + std::to_string(frames.columns) + " x " +
                         std::to_string(frames.rows) + " pixels");
  if (over_time && frames.count() < 2)
    throw InputError("contrast_over", values.over, "requires at least 2 frames");
  task.per_photon = keys.read(values.counts_per_photon);
  task.read_noise = keys.read(values.read_noise);
  return task;
}

int map_contrast(const Subcommand& command, ContrastKeys& values) {
  const Keys& keys = command.keys();
  const Session session(command.text(), keys, values.run, command.only_prints());
  const Frames frames =
      corrected_frames(keys, values.corrections, values.format, keys.required(values.frames));
  const mc::ContrastTask task = task_of(keys, values, frames);
  std::optional<mc::ExposureOfFrames> exposure;
  if (const auto& given = keys.read(values.exposure)) exposure = {*given, keys.read(values.beta)};
  if (!command.settle()) return ExitStatus::done;
  return session.once(ResultFile(session.out()), [&](ResultFile& file) {
    const auto map =
        naming_frames(values.frames.front(), [&] { return mc::contrast_map(frames, task); });
    mc::write_contrast(file, map, task.window, exposure);
    auto squares = map.square;
    std::ranges::sort(squares);
    std::printf("K^2: median %.4g, from %.4g to %.4g in 90 %% of the map; %.3g grains per window\n",
                squares[squares.size() / 2], squares[squares.size() / 20],
                squares[squares.size() - 1 - squares.size() / 20], 1 / map.correlation);
    return Made{"variance over mean squared in windows", static_cast<double>(frames.count())};
  });
}

}  // namespace

std::unique_ptr<Call> contrast(const std::string&) {
  return call_with<ContrastKeys>("contrast", "Maps of speckle contrast from frames of a camera",
                                 map_contrast);
}

}  // namespace flatspeckle::apps
