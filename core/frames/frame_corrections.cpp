#include "core/frames/frame_corrections.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "core/error.h"

namespace flatspeckle {

namespace {

std::string size_of(const Frames& frames) {
  return std::to_string(frames.columns) + " x " + std::to_string(frames.rows) + " pixels";
}

/// Reads the frames of all files, in their order.
Frames stack_of(const Keys& keys, const FrameFormat& format,
                const std::vector<std::string>& paths) {
  Frames all;
  for (const std::string& path : paths) {
    read_frame_keys(keys, format, path);
    Frames more = read_frames("frames", path, format);
    if (all.values.empty()) {
      all = std::move(more);
      continue;
    }
    if (more.rows != all.rows || more.columns != all.columns)
      throw InputError("frames", path,
                       "has " + size_of(more) + ", " + paths.front() + " has " + size_of(all));
    if (all.names.size() == all.count())
      all.names.insert(all.names.end(), more.names.begin(), more.names.end());
    all.values.insert(all.values.end(), more.values.begin(), more.values.end());
    all.full_scale = std::max(all.full_scale, more.full_scale);
  }
  return all;
}

/// Reads a file of frames of the same size as others, and returns their mean.
std::vector<double> mean_frame(const std::string& key, const std::string& path,
                               const FrameFormat& format, const Frames& like) {
  const Frames read = read_frames(key, path, format);
  if (read.rows != like.rows || read.columns != like.columns)
    throw InputError(key, path, "has " + size_of(read) + ", the frames have " + size_of(like));
  std::vector<double> mean(read.pixels());
  for (std::size_t i = 0; i < read.values.size(); ++i)
    mean[i % mean.size()] += read.values[i] / static_cast<double>(read.count());
  return mean;
}

void note_saturation(const Frames& frames) {
  if (frames.full_scale == 0) return;
  const auto saturated = std::ranges::count_if(
      frames.values, [&](double value) { return value >= frames.full_scale; });
  if (saturated > 0)
    std::fprintf(stderr, "note: %lld of %zu pixels have the largest value of the format, %g\n",
                 static_cast<long long>(saturated), frames.values.size(), frames.full_scale);
}

/// Divides each pixel by the relative sensitivity, that of the flat frame over its mean.
void divide_by(Frames& frames, const std::string& path, std::vector<double> flat,
               const std::vector<double>& dark) {
  for (std::size_t p = 0; p < dark.size(); ++p) flat[p] -= dark[p];
  const double mean = std::reduce(flat.begin(), flat.end()) / static_cast<double>(flat.size());
  if (!std::ranges::all_of(flat, [](double value) { return value > 0; }))
    throw InputError("flat", path,
                     "must be positive in all pixels (after subtraction of the dark "
                     "frame)");
  for (std::size_t i = 0; i < frames.values.size(); ++i)
    frames.values[i] *= mean / flat[i % flat.size()];
}

/// Returns the part of each frame in a region, with squares of `binning` pixels summed. Pixels that
/// do not fill a square are left out.
Frames cut(const Frames& frames, std::size_t left, std::size_t top, std::size_t width,
           std::size_t height, std::size_t binning) {
  Frames part{height / binning, width / binning, {}, 0, frames.names};
  for (std::size_t number = 0; number < frames.count(); ++number) {
    const auto frame = frames.frame(number);
    for (std::size_t y = 0; y < part.rows; ++y)
      for (std::size_t x = 0; x < part.columns; ++x) {
        double sum = 0;
        for (std::size_t row = 0; row < binning; ++row)
          for (std::size_t column = 0; column < binning; ++column)
            sum += frame[(top + y * binning + row) * frames.columns + left + x * binning + column];
        part.values.push_back(sum);
      }
  }
  return part;
}

}  // namespace

void add_correction_keys(Keys& keys, FrameCorrections& corrections) {
  keys.add("dark", corrections.dark,
           "File of dark frames; their mean is subtracted from the frames and from the flat frame")
      .file();
  keys.add("flat", corrections.flat,
           "File of frames of uniform light, by which the frames are divided")
      .file();
  keys.add("region", corrections.region,
           "Part of the frames that is used: first column, first row, width and height, in pixels")
      .exactly(4, "first column, first row, width, height")
      .from(0, 1e9);
  keys.add("binning", corrections.binning, "Side of the squares of pixels that are summed")
      .positive();
}

Frames corrected_frames(const Keys& keys, const FrameCorrections& corrections,
                        const FrameFormat& format, const std::vector<std::string>& paths) {
  Frames frames = stack_of(keys, format, paths);
  note_saturation(frames);
  std::vector<double> dark;
  if (const std::string& dark_path = keys.read(corrections.dark); !dark_path.empty()) {
    dark = mean_frame("dark", dark_path, format, frames);
    for (std::size_t i = 0; i < frames.values.size(); ++i)
      frames.values[i] -= dark[i % dark.size()];
  }
  if (const std::string& flat_path = keys.read(corrections.flat); !flat_path.empty())
    divide_by(frames, flat_path, mean_frame("flat", flat_path, format, frames), dark);
  std::vector<std::size_t> part{0, 0, frames.columns, frames.rows};
  if (const auto& region = keys.read(corrections.region); !region.empty())
    part.assign(region.begin(), region.end());
  const auto binning = static_cast<std::size_t>(keys.read(corrections.binning));
  if (part[0] + part[2] > frames.columns || part[1] + part[3] > frames.rows || part[2] < binning ||
      part[3] < std::min(binning, frames.rows))
    throw InputError("region = " + std::to_string(part[0]) + " " + std::to_string(part[1]) + " " +
                     std::to_string(part[2]) + " " + std::to_string(part[3]) +
                     ", binning = " + std::to_string(binning) + ": must lie in the frames of " +
                     paths.front() + ", which have " + size_of(frames));
  const bool line = frames.rows == 1;
  if (binning == 1 && part[2] == frames.columns && part[3] == frames.rows) return frames;
  if (line && binning > 1) throw InputError("binning", binning, "must be 1 for frames of one line");
  return cut(frames, part[0], part[1], part[2], part[3], binning);
}

}  // namespace flatspeckle
