#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "apps/results/array_files.h"
#include "core/error.h"

// Layout: "OpenEXR File Layout", openexr.com/en/latest/OpenEXRFileLayout.html. All numbers are
// little endian.

namespace flatspeckle::apps {

namespace {

/// Bytes of an OpenEXR file.
class ExrBytes {
 public:
  template <typename Number>
  ExrBytes& add(Number number) {
    static_assert(std::endian::native == std::endian::little);
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    text_.append(bytes, sizeof number);
    return *this;
  }
  /// Adds a text that ends with a byte 0.
  ExrBytes& name(const char* text) {
    text_.append(text, std::strlen(text) + 1);
    return *this;
  }
  /// Adds an attribute of the header.
  ExrBytes& attribute(const char* key, const char* type, const ExrBytes& value) {
    name(key).name(type).add(static_cast<std::int32_t>(value.text_.size()));
    text_ += value.text_;
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Returns the header of a picture with one channel Y of 32-bit floats, without compression, of
/// rows from the top.
ExrBytes exr_header(std::int32_t rows, std::int32_t columns) {
  constexpr std::int32_t magic = 20000630, version = 2, of_float = 2, every = 1, zero = 0;
  constexpr std::uint8_t none = 0;
  const auto byte = ExrBytes().add(none);
  const auto window = ExrBytes().add(zero).add(zero).add(columns - 1).add(rows - 1);
  const auto channels =
      ExrBytes().name("Y").add(of_float).add(zero).add(every).add(every).add(none);
  return ExrBytes()
      .add(magic)
      .add(version)
      .attribute("channels", "chlist", channels)
      .attribute("compression", "compression", byte)
      .attribute("dataWindow", "box2i", window)
      .attribute("displayWindow", "box2i", window)
      .attribute("lineOrder", "lineOrder", byte)
      .attribute("pixelAspectRatio", "float", ExrBytes().add(1.0F))
      .attribute("screenWindowCenter", "v2f", ExrBytes().add(0.0F).add(0.0F))
      .attribute("screenWindowWidth", "float", ExrBytes().add(1.0F))
      .add(none);
}

}  // namespace

void write_exr(const std::filesystem::path& path, const GreyPicture& picture) {
  ExrBytes bytes = exr_header(static_cast<std::int32_t>(picture.rows),
                              static_cast<std::int32_t>(picture.columns));
  const std::uint64_t of_pixels = 4 * picture.columns, of_line = 8 + of_pixels,
                      first = bytes.text().size() + 8 * picture.rows;
  for (std::uint64_t row = 0; row < picture.rows; ++row) bytes.add(first + row * of_line);
  for (std::size_t row = 0; row < picture.rows; ++row) {
    bytes.add(static_cast<std::int32_t>(row)).add(static_cast<std::int32_t>(of_pixels));
    for (std::size_t column = 0; column < picture.columns; ++column)
      bytes.add(static_cast<float>(picture.values[row * picture.columns + column]));
  }
  std::ofstream file(path, std::ios::binary);
  file << bytes.text();
  file.close();
  if (!file) throw IoError("cannot write " + path.string());
}

}  // namespace flatspeckle::apps
