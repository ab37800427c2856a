#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "apps/command/subcommands.h"
#include "core/error.h"
#include "core/keys/csv.h"
#include "core/session/session.h"
#include "mc/imaging/recovery/phase_retrieval.h"
#include "mc/imaging/recovery/recovery.h"
#include "mc/imaging/recovery/recovery_datasets.h"
#include "mc/imaging/unmixing/unmixing.h"

namespace flatspeckle::apps {

namespace {

/// What the user asks.
struct RecoverKeys {
  std::string frames, reference;
  std::optional<std::int64_t> points;
  std::optional<double> longest, memory_range;
  double resolution = 1;
  std::int64_t average = 1;
  mc::CameraNoise noise;
  mc::DeconvolutionKeys deconvolution;
  std::string recovery = "search";
  mc::PhaseTask phases;
  RunSettings run;
};

void add_keys(Keys& keys, RecoverKeys& values) {
  keys.add("frames", values.frames,
           "CSV file: a column for each frame, a row for each pixel along the line")
      .file();
  keys.add("points", values.points,
           "How many points are looked for (sources: default by the frames' singular values)")
      .from(2, 64);
  keys.add("longest", values.longest,
           "Longest distance of two points, pixels (default: an eighth of the frame)")
      .from(8, std::numeric_limits<double>::infinity());
  keys.add("resolution", values.resolution, "Least distance of points, in grains of the speckle")
      .positive();
  keys.add("memory_range", values.memory_range,
           "Distance of points whose speckles have the correlation C_I = 1/2, pixels, for a search "
           "that weighs pairs by it (default: all pairs alike)")
      .positive();
  mc::add_average_key(keys, values.average);
  keys.add("recovery", values.recovery,
           "search: points; phases: also a picture whose autocorrelation is the frame's, by hybrid "
           "input-output and error reduction; sources: of points that blink, frames of one medium, "
           "by non-negative factors")
      .one_of({"search", "phases", "sources"});
  keys.add("starts", values.phases.starts, "phases: from random ones, the best is taken")
      .from(1, 10000);
  keys.add("phase_iterations", values.phases.iterations, "phases: of each start").from(4, 100000);
  keys.add("sparsity", values.phases.sparsity,
           "phases: what is below this share of the largest value is 0 in error reduction")
      .from(0, 1);
  add_camera_keys(keys, values.noise);
  keys.add("reference", values.reference,
           "CSV file of a reference point's frame: one column, or one for each frame; frames are "
           "divided by it")
      .file();
  add_keys(keys, values.deconvolution);
  add_output_key(keys, values.run);
}

/// Of the longest distance.
std::size_t lags_of(const Keys& keys, const RecoverKeys& values, std::size_t pixels) {
  if (pixels < 64) throw InputError("frames", pixels, "pixels: a frame has at least 64");
  const auto most = static_cast<double>(pixels) / 4;
  const double longest = keys.read(values.longest).value_or(std::floor(most / 2));
  if (!(longest < most))
    throw InputError(
        "longest", longest,
        "must be less than a quarter of the frame's " + std::to_string(pixels) + " pixels");
  return static_cast<std::size_t>(longest) + 1;
}

mc::RecoveryTask task_of(const Keys& keys, const RecoverKeys& values, std::size_t pixels) {
  mc::RecoveryTask task;
  task.points = static_cast<std::size_t>(keys.required(values.points));
  task.resolution_grains = keys.read(values.resolution);
  task.memory_range = keys.read(values.memory_range).value_or(0);
  read_camera_keys(keys, values.noise, task.noise);
  task.lags = lags_of(keys, values, pixels);
  return task;
}

mc::UnmixingTask unmixing_task(const Keys& keys, const RecoverKeys& values, const Table& table) {
  mc::UnmixingTask task;
  task.sources = static_cast<std::size_t>(keys.read(values.points).value_or(0));
  task.resolution_grains = keys.read(values.resolution);
  read_camera_keys(keys, values.noise, task.noise);
  task.lags = lags_of(keys, values, table.rows());
  if (const std::size_t frames = table.names().size(); frames < 2)
    throw InputError("frames", frames, "columns: sources take two or more");
  return task;
}

/// Nothing where only points are looked for.
std::optional<mc::PhaseTask> phase_task(const Keys& keys, const RecoverKeys& values) {
  if (keys.read(values.recovery) == "search") return std::nullopt;
  mc::PhaseTask task;
  task.starts = keys.read(values.phases.starts);
  task.iterations = keys.read(values.phases.iterations);
  task.sparsity = keys.read(values.phases.sparsity);
  return task;
}

/// Frames of each object, side by side.
std::vector<std::vector<double>> frames_of(const Table& table) {
  std::vector<std::vector<double>> frames;
  for (const std::string& name : table.names()) {
    const auto column = table.column(name);
    frames.emplace_back(column.begin(), column.end());
  }
  return frames;
}

std::size_t average_of(const Keys& keys, const RecoverKeys& values, std::size_t frames) {
  const auto average = static_cast<std::size_t>(keys.read(values.average));
  if (frames % average != 0)
    throw InputError("average", average,
                     "does not divide the " + std::to_string(frames) + " frames");
  if (average > 1 && !keys.read(values.reference).empty())
    throw InputError("average", average, "frames with a reference are not averaged");
  return average;
}

/// Of each frame; nothing without a reference.
struct References {
  std::vector<std::vector<double>> of_frame;
  mc::DeconvolutionTask task;
};

References references_of(const Keys& keys, const RecoverKeys& values, const Table& frames) {
  References references;
  if (keys.read(values.reference).empty()) return references;
  references.task = deconvolution_task(keys, values.deconvolution);
  const Table table = read_key_table("reference", values.reference);
  const std::size_t columns = table.names().size(), count = frames.names().size();
  if (table.rows() != frames.rows())
    throw InputError("reference", table.rows(),
                     "pixels, but the frames have " + std::to_string(frames.rows()));
  if (columns != 1 && columns != count)
    throw InputError(
        "reference", columns,
        "columns: must be one, or one for each of " + std::to_string(count) + " frames");
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = table.column(table.names()[columns == 1 ? 0 : i]);
    references.of_frame.emplace_back(column.begin(), column.end());
  }
  return references;
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

void print_sources(const mc::Unmixed& found) {
  std::printf("%zu sources (singular values above %.3g), residual %.3g\n", found.count.sources,
              found.count.threshold, found.factors.residual);
  std::printf("%-8s %-8s %s\n", "source", "group", "place (pixels)");
  for (std::size_t s = 0; s < found.places.x.size(); ++s)
    std::printf("%-8zu %-8zu %.1f\n", s, found.places.group[s], found.places.x[s]);
}

using Make = std::function<Made(ResultFile&)>;

/// Points of each frame, and pictures.
Make search_of(const Keys& keys, const RecoverKeys& values, const Table& table) {
  const mc::RecoveryTask task = task_of(keys, values, table.rows());
  const std::size_t average = average_of(keys, values, table.names().size());
  const References references = references_of(keys, values, table);
  const auto phases = phase_task(keys, values);
  return [=](ResultFile& file) {
    std::vector<mc::Recovered> all;
    std::vector<mc::Deconvolved> pictures;
    std::vector<mc::PhasedPicture> phased;
    std::vector<std::string> names;
    const auto frames = frames_of(table);
    for (std::size_t i = 0; i < frames.size(); i += average) {
      if (!references.of_frame.empty())
        pictures.push_back(
            mc::deconvolved(frames[i], references.of_frame[i], task.lags, references.task));
      all.push_back(mc::recovered(std::span(frames).subspan(i, average), task));
      if (phases)
        phased.push_back(mc::retrieved_phases(all.back().statistics.autocorrelation, *phases));
      names.push_back(table.names()[i]);
    }
    mc::write_recovery(file, names, task, all);
    if (!pictures.empty()) mc::write_deconvolved(file, task, pictures);
    if (!phased.empty()) mc::write_phased(file, task, phased);
    print_summary(all);
    return Made{"autocorrelation of each frame, sparse search", static_cast<double>(all.size())};
  };
}

/// Sources of all frames together.
Make sources_of(const Keys& keys, const RecoverKeys& values, const Table& table) {
  const mc::UnmixingTask task = unmixing_task(keys, values, table);
  return [=](ResultFile& file) {
    const auto frames = frames_of(table);
    const mc::Unmixed found = mc::unmixed(frames, task);
    mc::write_unmixed(file, table.names(), found);
    print_sources(found);
    return Made{"non-negative factors of all frames, correlations of patterns",
                static_cast<double>(frames.size())};
  };
}

int recover_points(const Subcommand& command, RecoverKeys& values) {
  const Keys& keys = command.keys();
  const Session session(command.text(), keys, values.run, command.only_prints());
  const Table table = read_key_table("frames", keys.required(values.frames));
  const Make make = keys.read(values.recovery) == "sources" ? sources_of(keys, values, table)
                                                            : search_of(keys, values, table);
  if (!command.settle()) return ExitStatus::done;
  return session.once(ResultFile(session.out()), make);
}

}  // namespace

std::unique_ptr<Call> recover(const std::string&) {
  return call_with<RecoverKeys>("recover", "Points found in the autocorrelation of measured frames",
                                recover_points);
}

}  // namespace flatspeckle::apps
