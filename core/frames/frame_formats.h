#pragma once

#include <filesystem>
#include <string>

#include "core/frames/frames.h"

namespace flatspeckle {

// Readers of single formats. Each throws std::runtime_error with the reason why the file cannot be
// used; read_frames() adds key and file.

/// Formats that are read, as a request for one of them.
constexpr const char* accepted_pictures =
    "give a grey PNG, TIFF, NPY, PFM or HDF5, a Radiance HDR, or an EXR (uncompressed, ZIP, ZIPS "
    "or "
    "RLE)";

/// Weights of red, green and blue in the luminance of primaries as in ITU-R BT.709.
constexpr double luminance_weights[] = {0.2126, 0.7152, 0.0722};

/// Returns the grey values of pixels with several channels: grey or red, green and blue, and with
/// an even number of channels also the opacity. Throws if the colours differ or a pixel is not
/// opaque.
std::vector<double> grey_pixels(std::vector<double> values, std::size_t channels, double opaque);

/// allows_display: see FrameFormat.
Frames read_png(const std::filesystem::path& path, bool allows_display);
Frames read_tiff(const std::filesystem::path& path);
/// bytes: content of the file.
Frames read_npy(const std::string& bytes);
Frames read_pfm(const std::string& bytes);
Frames read_exr(const std::string& bytes);
Frames read_hdr(const std::string& bytes);

}  // namespace flatspeckle
