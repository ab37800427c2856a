#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/frames/frames.h"

namespace flatspeckle {

/// Corrections of frames before they are used, in this order: dark frame, flat field, region,
/// binning.
struct FrameCorrections {
  std::string dark, flat;              ///< files; empty if there is none
  std::vector<std::int64_t> region{};  ///< first column, first row, width, height; empty: all
  std::int64_t binning = 1;            ///< side of the squares of pixels that are summed
};

/// Adds the keys dark, flat, region and binning.
void add_correction_keys(Keys& keys, FrameCorrections& corrections);

/// Reads the keys and the files of the key `frames`, which must have frames of one size, and
/// corrects the frames. A dark or flat file holds one frame, or several, which are averaged. Prints
/// a note if pixels are saturated. Throws InputError.
Frames corrected_frames(const Keys& keys, const FrameCorrections& corrections,
                        const FrameFormat& format, const std::vector<std::string>& paths);

}  // namespace flatspeckle
