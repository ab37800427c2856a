#pragma once

#include <filesystem>
#include <string>

#include "core/frames/frames.h"

namespace flatspeckle {

// Readers of single formats. Each throws std::runtime_error with the reason why the file cannot be
// used; read_frames() adds key and file.

Frames read_png(const std::filesystem::path& path);
Frames read_tiff(const std::filesystem::path& path);
/// bytes: content of the file.
Frames read_npy(const std::string& bytes);
Frames read_pfm(const std::string& bytes);

}  // namespace flatspeckle
