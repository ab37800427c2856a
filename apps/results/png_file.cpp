#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <memory>
#include <png.h>

#include "apps/results/array_files.h"
#include "core/error.h"
#include "core/frames/png_notes.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

/// Grey pixels of a PNG file, of 8 or 16 bits. gamma: light in proportion to pixel^gamma.
struct PngPixels {
  png_uint_32 rows, columns;
  int depth;
  double gamma;
  std::vector<png_byte> bytes{};
  std::string note{};
};

[[noreturn]] void fail_write(png_structp png, png_const_charp) {
  png_longjmp(png, 1);
}
void ignore_warning(png_structp, png_const_charp) {}

/// libpng reports errors by longjmp(), so that this function has no objects with destructors.
bool encode(png_structp png, png_infop info, std::FILE* file, const PngPixels& pixels,
            png_textp text) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_init_io(png, file);
  png_set_IHDR(png, info, pixels.columns, pixels.rows, pixels.depth, PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_gAMA(png, info, 1 / pixels.gamma);
  png_set_text(png, info, text, 1);
  png_write_info(png, info);
  const std::size_t line = pixels.bytes.size() / pixels.rows;
  for (std::size_t row = 0; row < pixels.rows; ++row) png_write_row(png, &pixels.bytes[row * line]);
  png_write_end(png, info);
  return true;
}

void write(const std::filesystem::path& path, PngPixels& pixels) {
  std::string keyword = png_keyword;
  png_text text{};
  text.compression = PNG_TEXT_COMPRESSION_NONE;
  text.key = keyword.data();
  text.text = pixels.note.data();
  png_structp png =
      png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail_write, ignore_warning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  std::FILE* file = std::fopen(path.c_str(), "wb");
  const bool is_encoded =
      info != nullptr && file != nullptr && encode(png, info, file, pixels, &text);
  png_destroy_write_struct(&png, &info);
  const bool is_closed = file != nullptr && std::fclose(file) == 0;
  if (!is_encoded || !is_closed) throw IoError("cannot write " + path.string());
}

PngPixels pixels_for(const GreyPicture& picture, int depth, double gamma) {
  return {static_cast<png_uint_32>(picture.rows), static_cast<png_uint_32>(picture.columns), depth,
          gamma};
}

/// Returns the value that 99.5 % of the pixels do not exceed, or the largest if that is 0.
double white_of(std::vector<double> values) {
  const auto place = values.begin() +
                     static_cast<std::ptrdiff_t>(0.995 * (static_cast<double>(values.size()) - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place > 0 ? *place : *std::max_element(values.begin(), values.end());
}

}  // namespace

std::string write_display_png(const std::filesystem::path& path, const GreyPicture& picture) {
  constexpr double gamma = 2.2, top = 255;
  const double white = white_of(picture.values);
  PngPixels pixels = pixels_for(picture, 8, gamma);
  for (const double value : picture.values) {
    const double light = white > 0 ? std::clamp(value / white, 0.0, 1.0) : 0;
    pixels.bytes.push_back(static_cast<png_byte>(std::lround(top * std::pow(light, 1 / gamma))));
  }
  pixels.note = std::string(display_note) + " (gamma 2.2, white = " + number_text(white) + ")";
  write(path, pixels);
  return pixels.note;
}

std::string write_linear_png(const std::filesystem::path& path, const GreyPicture& picture) {
  constexpr double top = 65535;
  const auto [least, largest] = std::ranges::minmax_element(picture.values);
  if (*least < 0)
    throw InputError("linear", *least, "must be from 0 on; export negative values to .tif or .npy");
  const double counts = *largest > 0 ? top / *largest : 1;
  PngPixels pixels = pixels_for(picture, 16, 1);
  for (const double value : picture.values) {
    const auto count = static_cast<unsigned>(std::lround(counts * value));
    pixels.bytes.push_back(static_cast<png_byte>(count >> 8));
    pixels.bytes.push_back(static_cast<png_byte>(count & 255));
  }
  pixels.note = std::string(linear_note) + " (count = " + number_text(counts) + " * value)";
  write(path, pixels);
  return pixels.note;
}

}  // namespace flatspeckle::apps
