#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/keys/keys.h"

namespace flatspeckle {

/// Frames of a camera, all of one size.
struct Frames {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;  ///< [frame][row][column], in the units of the file
  /// Largest value that the file's format can hold, at which pixels may be saturated; 0 if the
  /// format has no such value.
  double full_scale = 0;
  std::vector<std::string> names{};  ///< of the frames, if the file contains them

  std::size_t pixels() const { return rows * columns; }
  std::size_t count() const { return pixels() == 0 ? 0 : values.size() / pixels(); }
  std::span<const double> frame(std::size_t number) const {
    return std::span(values).subspan(number * pixels(), pixels());
  }
};

/// How to read files of frames that do not say it themselves.
struct FrameFormat {
  std::string dataset;           ///< HDF5: name of the dataset; empty if the file has only one
  std::string axes = "unknown";  ///< CSV: columns (one line of pixels in each) or picture
  /// Whether PNG files of `export` for display are read, whose pixels are not proportional to the
  /// values that were exported
  bool allows_display = false;
};

/// Adds the keys of FrameFormat.
void add_frame_keys(Keys& keys, FrameFormat& format);
/// Reads those of the keys that apply to the format of a file.
void read_frame_keys(const Keys& keys, const FrameFormat& format,
                     const std::filesystem::path& path);

/// Whether a file is a table of text, by its first bytes.
bool is_text_frames(const std::filesystem::path& path);

/// Calls f(). An InputError about the key `frames` then also names the file.
template <typename F>
auto naming_frames(const std::string& path, const F& f) {
  const std::string key = "frames: ";
  try {
    return f();
  } catch (const InputError& error) {
    const std::string text = error.what();
    if (!text.starts_with(key)) throw;
    throw InputError("frames = " + path + ": " + text.substr(key.size()));
  }
}

/// Reads frames from PNG (8 or 16 bit), TIFF (one or several pages), NPY, PFM, OpenEXR, Radiance
/// HDR, HDF5 or CSV. Colour channels must be equal, except in OpenEXR and HDR, of which the
/// luminance is read.
/// The content of the file tells its format. Throws InputError, which names the key and the file,
/// for files that are damaged, that have colours, or that can be read in several ways.
Frames read_frames(const std::string& key, const std::filesystem::path& path,
                   const FrameFormat& format);

}  // namespace flatspeckle
