#include <csetjmp>
#include <cstdio>
#include <memory>
#include <png.h>
#include <stdexcept>
#include <utility>

#include "core/frames/frame_formats.h"
#include "core/frames/png_notes.h"

namespace flatspeckle {

namespace {

/// Picture that libpng decodes. libpng reports errors by longjmp(), so that the functions that
/// call setjmp() have no objects with destructors.
struct Decoded {
  png_uint_32 width = 0, height = 0;
  int depth = 0;
  std::size_t channels = 1;
  std::vector<png_byte> bytes;
  std::vector<png_bytep> rows;
};

[[noreturn]] void fail(png_structp png, png_const_charp) {
  png_longjmp(png, 1);
}
void silent(png_structp, png_const_charp) {}

bool decode_header(png_structp png, png_infop info, std::FILE* file, Decoded& found) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_init_io(png, file);
  png_read_info(png, info);
  found.width = png_get_image_width(png, info);
  found.height = png_get_image_height(png, info);
  found.depth = png_get_bit_depth(png, info);
  if (found.depth < 8) png_set_expand_gray_1_2_4_to_8(png);
  if (png_get_color_type(png, info) == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
  if (png_get_color_type(png, info) == PNG_COLOR_TYPE_GRAY_ALPHA) png_set_strip_alpha(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  found.channels = png_get_channels(png, info);
  return true;
}

bool decode_rows(png_structp png, Decoded& found) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_image(png, found.rows.data());
  return true;
}

/// Returns the text that `export` writes into PNG files; empty for files of other programs.
std::string note_in(png_structp png, png_infop info) {
  png_textp texts = nullptr;
  int count = 0;
  png_get_text(png, info, &texts, &count);
  for (int i = 0; i < count; ++i)
    if (std::string_view(texts[i].key) == png_keyword) return texts[i].text;
  return {};
}

}  // namespace

Frames read_png(const std::filesystem::path& path, bool allows_display) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (!file) throw std::runtime_error("cannot be read");
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, silent);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  if (info == nullptr) throw std::runtime_error("no memory for the PNG library");
  struct Release {
    png_structp png;
    png_infop info;
    ~Release() { png_destroy_read_struct(&png, &info, nullptr); }
  } const release{png, info};
  Decoded found;
  if (!decode_header(png, info, file.get(), found))
    throw std::runtime_error("is a damaged PNG file");
  const std::string note = note_in(png, info);
  if (note.starts_with(display_note) && !allows_display)
    throw std::runtime_error("is a picture " + note +
                             ": export it with --linear, or to .tif, .npy or .pfm");
  const std::size_t row_bytes = png_get_rowbytes(png, info);
  found.bytes.resize(row_bytes * found.height);
  for (std::size_t row = 0; row < found.height; ++row)
    found.rows.push_back(&found.bytes[row * row_bytes]);
  if (!decode_rows(png, found)) throw std::runtime_error("is a damaged PNG file");
  const double largest = found.depth == 16 ? 65535 : 255;
  std::vector<double> values;
  for (const png_bytep row : found.rows)
    for (std::size_t x = 0; x < found.channels * found.width; ++x)
      values.push_back(found.depth == 16 ? 256.0 * row[2 * x] + row[2 * x + 1] : row[x]);
  return {found.height, found.width, grey_pixels(std::move(values), found.channels, largest),
          note.starts_with(linear_note) ? 0 : largest};
}

}  // namespace flatspeckle
