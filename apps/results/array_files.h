#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace flatspeckle::apps {

/// Numbers in row-major order, to be written in formats that other programs read.
struct NumberArray {
  std::vector<std::size_t> shape;
  std::vector<double> values;
  bool is_complex = false;  ///< whether each number has two values, its real and imaginary part
};

/// A picture, rows from the top.
struct GreyPicture {
  std::size_t rows, columns;
  std::vector<double> values;
};

// The following functions write files. They throw IoError.

/// NumPy format, version 1, float64 or complex128.
void write_npy(const std::filesystem::path& path, const NumberArray& array);
/// Portable float map of one channel, 32 bits.
void write_pfm(const std::filesystem::path& path, const GreyPicture& picture);
/// OpenEXR of one channel Y, 32-bit floats without compression.
void write_exr(const std::filesystem::path& path, const GreyPicture& picture);
/// PNG of 8 bits for display. Values are divided by the one that 99.5 % of the pixels do not
/// exceed, cut off at 1, and raised to the power 1/2.2. Returns the note that the file contains
/// about this.
std::string write_display_png(const std::filesystem::path& path, const GreyPicture& picture);
/// PNG of 16 bits whose counts are proportional to the values; the largest value has 65535. Returns
/// the note that the file contains about the factor. Throws InputError for negative values.
std::string write_linear_png(const std::filesystem::path& path, const GreyPicture& picture);
/// TIFF of 32-bit floats: one page for each frame. array: [row][column] or [frame][row][column].
void write_tiff(const std::filesystem::path& path, const NumberArray& array);
/// Legacy VTK file of structured points. array: [x][y][z]; origin, spacing: three numbers each.
void write_vtk(const std::filesystem::path& path, const std::string& name, const NumberArray& array,
               const std::vector<double>& origin, const std::vector<double>& spacing);

}  // namespace flatspeckle::apps
