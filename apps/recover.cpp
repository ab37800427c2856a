#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "apps/command/subcommands.h"
#include "core/error.h"
#include "core/keys/csv.h"
#include "core/session/session.h"
#include "mc/recovery/recovery_datasets.h"

namespace flatspeckle::apps {

namespace {

/// What the user asks.
struct RecoverKeys {
  std::string frames;
  std::optional<std::int64_t> points;
  std::optional<double> longest;
  double resolution = 1;
  mc::CameraNoise noise;
  RunSettings run;
};

void add_keys(Keys& keys, RecoverKeys& values) {
  keys.add("frames", values.frames,
           "CSV file: a column for each frame, a row for each pixel along the line")
      .file();
  keys.add("points", values.points, "How many points are looked for").from(2, 64);
  keys.add("longest", values.longest,
           "Longest distance of two points, pixels (default: an eighth of the frame)")
      .from(8, std::numeric_limits<double>::infinity());
  keys.add("resolution", values.resolution, "Least distance of points, in grains of the speckle")
      .positive();
  keys.add("photons", values.noise.photons,
           "Of the camera: detected per pixel, mean (default 0: no shot noise)")
      .not_negative();
  keys.add("read_noise", values.noise.read_noise, "Standard deviation, photons").not_negative();
  add_output_key(keys, values.run);
}

mc::RecoveryTask task_of(const Keys& keys, const RecoverKeys& values, std::size_t pixels) {
  mc::RecoveryTask task;
  task.points = static_cast<std::size_t>(keys.required(values.points));
  task.resolution_grains = keys.read(values.resolution);
  task.noise.photons = keys.read(values.noise.photons);
  if (task.noise.photons > 0) task.noise.read_noise = keys.read(values.noise.read_noise);
  if (pixels < 64) throw InputError("frames", pixels, "pixels: a frame has at least 64");
  const auto most = static_cast<double>(pixels) / 4;
  const double longest = keys.read(values.longest).value_or(std::floor(most / 2));
  if (!(longest < most))
    throw InputError(
        "longest", longest,
        "must be less than a quarter of the frame's " + std::to_string(pixels) + " pixels");
  task.lags = static_cast<std::size_t>(longest) + 1;
  return task;
}

void print_summary(const std::vector<mc::Recovered>& all) {
  std::printf("%-8s %-9s %-8s %-10s %s\n", "frame", "contrast", "grains", "explained",
              "points (pixels; mirrored or not)");
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::printf("%-8zu %-9.3f %-8.0f %-10.3f", i, all[i].statistics.contrast,
                all[i].statistics.grains, all[i].fit.explained);
    for (const double x : all[i].fit.object.x) std::printf(" %.0f", x);
    std::puts("");
  }
}

}  // namespace

int recover(const Arguments& arguments) {
  RecoverKeys values;
  Subcommand command("recover", "Points found in the autocorrelation of measured frames");
  Keys& keys = command.keys();
  add_keys(keys, values);
  if (!command.parse(arguments)) return ExitStatus::done;

  const Session session(command.text(), keys, values.run, command.only_prints());
  const Table table = read_csv(keys.required(values.frames));
  const mc::RecoveryTask task = task_of(keys, values, table.rows());
  keys.refuse_unread();
  if (!command.settle()) return ExitStatus::done;
  return session.once(ResultFile(session.out()), [&](ResultFile& file) -> std::optional<Made> {
    std::vector<mc::Recovered> all;
    for (const std::string& name : table.names())
      all.push_back(mc::recovered(table.column(name), task));
    mc::write_recovery(file, table.names(), task, all);
    print_summary(all);
    return Made{"autocorrelation of each frame, sparse search", static_cast<double>(all.size())};
  });
}

}  // namespace flatspeckle::apps
