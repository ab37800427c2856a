#include "apps/results/array_files.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <tiffio.h>

#include "core/error.h"

namespace flatspeckle::apps {

namespace {

/// Writes a header and then the bytes of a file.
void write_bytes(const std::filesystem::path& path, const std::string& header, const void* bytes,
                 std::size_t count) {
  std::ofstream file(path, std::ios::binary);
  file << header;
  file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  file.close();
  if (!file) throw IoError("cannot write " + path.string());
}

static_assert(std::endian::native == std::endian::little);

double big_endian(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  bits = __builtin_bswap64(bits);
  std::memcpy(&value, &bits, sizeof bits);
  return value;
}

}  // namespace

void write_npy(const std::filesystem::path& path, const NumberArray& array) {
  std::ostringstream text;
  text << "{'descr': '" << (array.is_complex ? "<c16" : "<f8")
       << "', 'fortran_order': False, 'shape': (";
  for (const std::size_t extent : array.shape) text << extent << ", ";
  text << "), }";
  std::string header = text.str();
  constexpr std::size_t before = 10, alignment = 64;
  while ((before + header.size() + 1) % alignment != 0) header += ' ';
  header += '\n';
  const auto length = static_cast<std::uint16_t>(header.size());
  std::string magic("\x93NUMPY\x01\x00", 8);
  magic += static_cast<char>(length & 255);
  magic += static_cast<char>(length >> 8);
  write_bytes(path, magic + header, array.values.data(), array.values.size() * sizeof(double));
}

void write_pfm(const std::filesystem::path& path, const GreyPicture& picture) {
  std::vector<float> pixels;
  for (std::size_t row = picture.rows; row-- > 0;)  // from the bottom
    for (std::size_t column = 0; column < picture.columns; ++column)
      pixels.push_back(static_cast<float>(picture.values[row * picture.columns + column]));
  std::ostringstream header;
  header << "Pf\n" << picture.columns << ' ' << picture.rows << "\n-1.0\n";
  write_bytes(path, header.str(), pixels.data(), pixels.size() * sizeof(float));
}

void write_tiff(const std::filesystem::path& path, const NumberArray& array) {
  const std::size_t columns = array.shape.back(), rows = array.shape[array.shape.size() - 2];
  std::vector<float> pixels(array.values.begin(), array.values.end());
  TIFFSetErrorHandler(nullptr);
  const std::unique_ptr<TIFF, void (*)(TIFF*)> file(TIFFOpen(path.c_str(), "w"), TIFFClose);
  bool written = file != nullptr;
  for (std::size_t row = 0; written && row * columns < pixels.size(); ++row) {
    if (row % rows == 0) {
      TIFFSetField(file.get(), TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(columns));
      TIFFSetField(file.get(), TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(rows));
      TIFFSetField(file.get(), TIFFTAG_BITSPERSAMPLE, 32);
      TIFFSetField(file.get(), TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
      TIFFSetField(file.get(), TIFFTAG_SAMPLESPERPIXEL, 1);
      TIFFSetField(file.get(), TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
      TIFFSetField(file.get(), TIFFTAG_ROWSPERSTRIP, static_cast<std::uint32_t>(rows));
    }
    written = TIFFWriteScanline(file.get(), &pixels[row * columns],
                                static_cast<std::uint32_t>(row % rows)) == 1;
    if (row % rows == rows - 1) written = written && TIFFWriteDirectory(file.get()) == 1;
  }
  if (!written) throw IoError("cannot write " + path.string());
}

void write_vtk(const std::filesystem::path& path, const std::string& name, const NumberArray& array,
               const std::vector<double>& origin, const std::vector<double>& spacing) {
  const auto& n = array.shape;
  std::ostringstream header;
  header.precision(17);
  header << "# vtk DataFile Version 3.0\n"
         << name << "\nBINARY\nDATASET STRUCTURED_POINTS\n"
         << "DIMENSIONS " << n[0] << ' ' << n[1] << ' ' << n[2] << "\nORIGIN " << origin[0] << ' '
         << origin[1] << ' ' << origin[2] << "\nSPACING " << spacing[0] << ' ' << spacing[1] << ' '
         << spacing[2] << "\nPOINT_DATA " << array.values.size() << "\nSCALARS " << name
         << " double 1\nLOOKUP_TABLE default\n";
  std::vector<double> values;  // x varies fastest
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i)
        values.push_back(big_endian(array.values[(i * n[1] + j) * n[2] + k]));
  write_bytes(path, header.str(), values.data(), values.size() * sizeof(double));
}

}  // namespace flatspeckle::apps
