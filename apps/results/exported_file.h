#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace flatspeckle::apps {

/// How export_file() writes a dataset.
struct ExportFormat {
  std::int64_t nodes;               ///< along each axis at which fields of `design` are sampled
  std::vector<std::string> select;  ///< texts AXIS=INDEX, each of which reduces an axis
  bool linear = false;  ///< whether PNG has counts in proportion to the values, for other programs
};

/// Writes a dataset of a result in the format that the ending of `to` names: .npy, .pfm, .exr,
/// .png, .tif (or .tiff) or .vtk. Pictures and frames of complex numbers contain their squared
/// magnitude. The datasets ball_spline, radial_spline and excess of `design` are written as the
/// index at points. Returns a line that describes the file. Throws InputError for a dataset that
/// the format cannot contain, and IoError.
std::string export_file(const std::filesystem::path& result, const std::string& dataset,
                        const std::filesystem::path& to, const ExportFormat& format);

/// Whether a dataset is a field of `design`, which export_file() samples.
bool is_designed_field(const std::string& dataset);

}  // namespace flatspeckle::apps
