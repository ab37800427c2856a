#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "apps/command/subcommands.h"
#include "core/error.h"
#include "core/frames/frame_corrections.h"
#include "core/frames/frames.h"
#include "core/session/session.h"
#include "mc/imaging/recovery/phase_retrieval.h"
#include "mc/imaging/recovery/recovery.h"
#include "mc/imaging/recovery/recovery_datasets.h"
#include "mc/imaging/retrieval/bispectrum.h"
#include "mc/imaging/retrieval/picture_datasets.h"
#include "mc/imaging/separation/separation.h"

namespace flatspeckle::apps {

namespace {

/// Values of the keys of the subcommand `recover`.
struct RecoverKeys {
  std::vector<std::string> frames{};
  std::string reference;
  FrameFormat format;
  FrameCorrections corrections;
  std::optional<std::int64_t> points;
  std::optional<double> longest, memory_range;
  double resolution = 1;
  std::int64_t average = 1;
  mc::CameraNoise noise;
  mc::DeconvolutionKeys deconvolution;
  std::string recovery = "auto";
  mc::PhaseTask phases;
  RunSettings run;
};

void add_keys(Keys& keys, RecoverKeys& values) {
  keys.add(
          "frames", values.frames,
          "Frames of a camera: one file or several, PNG, TIFF, NPY, PFM, HDF5 or CSV. A table with "
          "column names has frames of one line, one in each column")
      .file();
  add_frame_keys(keys, values.format);
  add_correction_keys(keys, values.corrections);
  keys.add("points", values.points,
           "Number of points to recover (required, except that with recovery = sources the default "
           "follows from the singular values of the frames)")
      .from(2, 64);
  keys.add("longest", values.longest,
           "Longest distance between two points, in pixels (default: 1/8 of the frame)")
      .from(8, std::numeric_limits<double>::infinity());
  keys.add("resolution", values.resolution, "Smallest distance between points, in speckle grains")
      .positive();
  keys.add(
          "memory_range", values.memory_range,
          "Distance in pixels between two points at which the intensity correlation C_I of their "
          "speckles is 1/2; determines the weights of pairs in the search (default: equal weights)")
      .positive();
  mc::add_average_key(keys, values.average);
  keys.add("recovery", values.recovery,
           "search: recover points, from the peaks of their pairs in the autocorrelation; phases: "
           "also retrieve a picture that has the frame's "
           "autocorrelation, by hybrid input-output and error reduction; sources: locate blinking "
           "points from all frames of one medium, by non-negative factorisation; bispectrum: "
           "retrieve "
           "a picture that is not rotated, by the mean bispectrum of windows of the frames; auto: "
           "search for frames of one line, phases for pictures")
      .one_of({"auto", "search", "phases", "sources", "bispectrum"});
  mc::add_keys(keys, values.phases);
  add_camera_keys(keys, values.noise);
  keys.add("reference", values.reference,
           "File with the frame of a reference point: one frame for all frames, or one for each; "
           "frames are divided (deconvolved) by it")
      .file();
  add_keys(keys, values.deconvolution);
  add_thread_key(keys, values.run);
  add_output_key(keys, values.run);
}

/// Returns the number of lags of the autocorrelation, in pixels, that is needed for the longest
/// distance between points.
std::size_t lags_of(const Keys& keys, const RecoverKeys& values, std::size_t pixels) {
  if (pixels < 64)
    throw InputError("frames: have " + std::to_string(pixels) + " pixels, must have at least 64");
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

mc::SeparationTask separation_task(const Keys& keys, const RecoverKeys& values,
                                   const Frames& frames) {
  mc::SeparationTask task;
  task.sources = static_cast<std::size_t>(keys.read(values.points).value_or(0));
  task.resolution_grains = keys.read(values.resolution);
  read_camera_keys(keys, values.noise, task.noise);
  task.rows = frames.rows;
  task.lags = lags_of(keys, values,
                      frames.rows == 1 ? frames.columns : std::min(frames.rows, frames.columns));
  if (frames.count() < 2)
    throw InputError("frames: recovery = sources requires at least 2 frames (columns of a table)");
  return task;
}

/// Returns the task of phase retrieval; nullopt unless recovery = phases.
std::optional<mc::PhaseTask> phase_task(const Keys& keys, const RecoverKeys& values) {
  if (keys.read(values.recovery) != "phases") return std::nullopt;
  return mc::phase_task(keys, values.phases);
}

/// Returns the frames as lists of pixels.
std::vector<std::vector<double>> lists_of(const Frames& frames) {
  std::vector<std::vector<double>> lists;
  for (std::size_t number = 0; number < frames.count(); ++number) {
    const auto frame = frames.frame(number);
    lists.emplace_back(frame.begin(), frame.end());
  }
  return lists;
}

/// Returns the names of the frames; their numbers if they have no names.
std::vector<std::string> names_of(const Frames& frames) {
  std::vector<std::string> names = frames.names;
  for (std::size_t number = names.size(); number < frames.count(); ++number)
    names.push_back(std::to_string(number));
  return names;
}

std::size_t average_of(const Keys& keys, const RecoverKeys& values, std::size_t frames) {
  const auto average = static_cast<std::size_t>(keys.read(values.average));
  if (frames % average != 0)
    throw InputError("average", average, "must divide the " + std::to_string(frames) + " frames");
  if (average > 1 && !keys.read(values.reference).empty())
    throw InputError("average", average, "must be 1 with a reference");
  return average;
}

/// Frames of the reference point that belong to the frames; empty if there is no reference.
struct References {
  std::vector<std::vector<double>> of_frame;
  mc::DeconvolutionTask task;
};

References references_of(const Keys& keys, const RecoverKeys& values, const Frames& frames) {
  References references;
  if (keys.read(values.reference).empty()) return references;
  references.task = deconvolution_task(keys, values.deconvolution);
  const Frames read = read_frames("reference", values.reference, values.format);
  if (read.pixels() != frames.columns)
    throw InputError("reference: has " + std::to_string(read.pixels()) +
                     " pixels, the frames have " + std::to_string(frames.columns));
  if (read.count() != 1 && read.count() != frames.count())
    throw InputError("reference: has " + std::to_string(read.count()) +
                     " columns, must have one, or " + std::to_string(frames.count()) +
                     " as the frames");
  for (std::size_t i = 0; i < frames.count(); ++i) {
    const auto frame = read.frame(read.count() == 1 ? 0 : i);
    references.of_frame.emplace_back(frame.begin(), frame.end());
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

void print_sources(const mc::SeparatedSources& found) {
  std::printf("%zu sources (singular values above %.3g), residual %.3g\n", found.count.sources,
              found.count.threshold, found.factors.residual);
  std::printf("%-8s %-8s %s\n", "source", "group", "position (pixels)");
  for (std::size_t s = 0; s < found.places.x.size(); ++s) {
    std::printf("%-8zu %-8zu %.1f", s, found.places.group[s], found.places.x[s]);
    if (found.rows > 1) std::printf(", %.1f", found.places.y[s]);
    std::puts("");
  }
}

using Make = std::function<Made(ResultFile&)>;

/// Returns the function that recovers the points of the object from each frame, and pictures if
/// requested, and writes the result.
Make search_of(const Keys& keys, const RecoverKeys& values, const Frames& read) {
  const mc::RecoveryTask task = task_of(keys, values, read.columns);
  const std::size_t average = average_of(keys, values, read.count());
  const References references = references_of(keys, values, read);
  const auto phases = phase_task(keys, values);
  return [=](ResultFile& file) {
    std::vector<mc::Recovered> all;
    std::vector<mc::Deconvolved> pictures;
    std::vector<mc::RetrievedPicture> phased;
    std::vector<std::string> names;
    const auto frames = lists_of(read);
    const auto all_names = names_of(read);
    for (std::size_t i = 0; i < frames.size(); i += average) {
      if (!references.of_frame.empty())
        pictures.push_back(
            mc::deconvolved(frames[i], references.of_frame[i], task.lags, references.task));
      all.push_back(mc::recovered(std::span(frames).subspan(i, average), task));
      if (phases)
        phased.push_back(mc::retrieved_line(all.back().statistics.autocorrelation, *phases));
      names.push_back(all_names[i]);
    }
    mc::write_recovery(file, names, task, all);
    if (!pictures.empty()) mc::write_deconvolved(file, task, pictures);
    if (!phased.empty()) mc::write_phased(file, task, phased);
    print_summary(all);
    return Made{"autocorrelation of each frame, sparse search", static_cast<double>(all.size())};
  };
}

/// Returns the function that separates the frames into the contributions of blinking sources and
/// writes the result.
Make sources_of(const Keys& keys, const RecoverKeys& values, const Frames& read) {
  const mc::SeparationTask task = separation_task(keys, values, read);
  return [=](ResultFile& file) {
    const auto frames = lists_of(read);
    const mc::SeparatedSources found = mc::separated_sources(frames, task);
    mc::write_separation(file, names_of(read), found);
    print_sources(found);
    return Made{"non-negative factors of all frames, correlations of patterns",
                static_cast<double>(frames.size())};
  };
}

void print_points(const std::vector<mc::RecoveredPicture>& all) {
  std::printf("%-8s %-9s %-8s %-10s %s\n", "frame", "contrast", "peak", "explained",
              "points (x, y in pixels; rotated by 180 degrees or not)");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& [statistics, retrieved, points] = all[i];
    std::printf("%-8zu %-9.3f %-8.2f %-10.3f", i, statistics.contrast, statistics.grain,
                points.explained);
    for (std::size_t n = 0; n < points.x.size(); ++n)
      std::printf(" (%.1f, %.1f)", points.x[n], points.y[n]);
    std::puts("");
  }
}

void print_pictures(const std::vector<mc::RecoveredPicture>& all) {
  std::printf("%-8s %-9s %-8s %-10s %-9s %s\n", "frame", "contrast", "peak", "noise", "residual",
              "agreement of starts");
  for (std::size_t i = 0; i < all.size(); ++i)
    std::printf("%-8zu %-9.3f %-8.2f %-10.2g %-9.3f %.3f\n", i, all[i].statistics.contrast,
                all[i].statistics.grain, all[i].statistics.noise, all[i].retrieved.residual.back(),
                all[i].retrieved.agreement);
}

/// Returns the function that retrieves a picture or points from each frame, and writes the result.
Make pictures_of(const Keys& keys, const RecoverKeys& values, const Frames& frames) {
  const bool oriented = keys.read(values.recovery) == "bispectrum";
  const std::size_t sought =
      values.recovery == "search" ? static_cast<std::size_t>(keys.required(values.points)) : 0;
  const double resolution = sought > 0 ? keys.read(values.resolution) : 0;
  const std::size_t pixels = std::min(frames.rows, frames.columns);
  mc::CameraNoise noise;
  read_camera_keys(keys, values.noise, noise);
  const std::size_t lags = lags_of(keys, values, pixels),
                    average = average_of(keys, values, frames.count());
  mc::PhaseTask task;
  if (oriented) {  // it has one start
    task.iterations = keys.read(values.phases.iterations);
    task.sparsity = keys.read(values.phases.sparsity);
  } else if (sought == 0) {
    task = mc::phase_task(keys, values.phases);
  }
  return [=](ResultFile& file) {
    std::vector<mc::RecoveredPicture> all;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < frames.count(); i += average) {
      auto statistics = mc::picture_statistics(frames, i, average, lags, noise);
      mc::RecoveredPicture one;
      if (sought > 0)
        one.points = mc::picture_points(statistics, lags, sought, resolution * statistics.grain);
      else
        one.retrieved = oriented
                            ? mc::oriented_picture(frames, i, average, statistics, lags, task)
                            : mc::retrieved_picture(statistics.autocorrelation, {lags, lags}, task);
      one.statistics = std::move(statistics);
      all.push_back(std::move(one));
      names.push_back(names_of(frames)[i]);
    }
    mc::write_pictures(file, names, lags, sought, all);
    sought > 0 ? print_points(all) : print_pictures(all);
    return Made{sought > 0 ? "autocorrelation of each frame, search for points"
                : oriented ? "bispectrum of windows of each frame, error reduction"
                           : "autocorrelation of each frame, phase retrieval",
                static_cast<double>(all.size())};
  };
}

Make make_of(const Keys& keys, const RecoverKeys& values, const Frames& frames) {
  if (keys.read(values.recovery) == "sources") return sources_of(keys, values, frames);
  if (frames.rows > 1) return pictures_of(keys, values, frames);
  if (values.recovery == "bispectrum")
    throw InputError("recovery", values.recovery, "requires frames that are pictures");
  return search_of(keys, values, frames);
}

int recover_points(const Subcommand& command, RecoverKeys& values) {
  const Keys& keys = command.keys();
  const Session session(command.text(), keys, values.run, command.only_prints());
  const Frames frames =
      corrected_frames(keys, values.corrections, values.format, keys.required(values.frames));
  return naming_frames(values.frames.front(), [&]() -> int {
    const Make make = make_of(keys, values, frames);
    if (!command.settle()) return ExitStatus::done;
    return session.once(ResultFile(session.out()), make);
  });
}

}  // namespace

std::unique_ptr<Call> recover(const std::string&) {
  return call_with<RecoverKeys>(
      "recover", "Recovers points or pictures from the autocorrelation of measured frames",
      recover_points);
}

}  // namespace flatspeckle::apps
