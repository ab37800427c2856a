#include <bit>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "core/frames/frame_formats.h"

namespace flatspeckle {

namespace {

/// Header of a file in the NPY format of NumPy, versions 1 to 3.
struct Header {
  std::string type;  ///< such as <u2: order of bytes, kind and bytes per value
  std::vector<std::size_t> shape;
  bool by_columns = false;  ///< whether the first index is the fastest (Fortran order)
  std::size_t begin = 0;    ///< of the values
};

/// Returns the text between `from` and `to` after the key of a header.
std::string after(const std::string& header, const std::string& key, char from, char to) {
  const std::size_t place = header.find("'" + key + "'");
  const std::size_t first = header.find(from, header.find(':', place));
  const std::size_t last = header.find(to, first + 1);
  if (place == std::string::npos || first == std::string::npos || last == std::string::npos)
    throw std::runtime_error("is a damaged NPY file");
  return header.substr(first + 1, last - first - 1);
}

Header header_of(const std::string& bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(bytes.at(i)); };
  std::size_t length = 0, place = 10;
  try {
    if (byte(6) == 1) {
      length = byte(8) + 256U * byte(9);
    } else {
      place = 12;
      for (std::size_t i = 0; i < 4; ++i) length += std::size_t{byte(8 + i)} << (8 * i);
    }
  } catch (const std::out_of_range&) {
    throw std::runtime_error("is a damaged NPY file");
  }
  const std::string text = bytes.substr(std::min(place, bytes.size()), length);
  Header header{after(text, "descr", '\'', '\''), {}, false, place + length};
  header.by_columns = after(text, "fortran_order", ' ', ',') == "True";
  std::istringstream numbers(after(text, "shape", '(', ')'));
  try {
    for (std::string number; std::getline(numbers, number, ',');)
      if (number.find_first_of("0123456789") != std::string::npos)
        header.shape.push_back(std::stoull(number));
  } catch (const std::out_of_range&) {
    throw std::runtime_error("has an axis longer than any memory");
  }
  return header;
}

template <typename Value>
std::vector<double> values_of(std::string_view bytes) {
  std::vector<double> values;
  for (std::size_t i = 0; i + sizeof(Value) <= bytes.size(); i += sizeof(Value)) {
    Value value;
    std::memcpy(&value, bytes.data() + i, sizeof(Value));
    values.push_back(static_cast<double>(value));
  }
  return values;
}

/// Returns values that are stored with the first index as the fastest in the order of rows.
std::vector<double> row_by_row(const std::vector<double>& values, std::size_t frames,
                               std::size_t rows, std::size_t columns) {
  std::vector<double> ordered;
  ordered.reserve(values.size());
  for (std::size_t frame = 0; frame < frames; ++frame)
    for (std::size_t y = 0; y < rows; ++y)
      for (std::size_t x = 0; x < columns; ++x)
        ordered.push_back(values[frame + frames * (y + rows * x)]);
  return ordered;
}

struct Type {
  const char* name;
  std::size_t size;
  std::vector<double> (*values)(std::string_view bytes);
  double full_scale;
};

constexpr Type types[] = {
    {"|u1", 1, values_of<std::uint8_t>, 255}, {"<u2", 2, values_of<std::uint16_t>, 65535},
    {"<u4", 4, values_of<std::uint32_t>, 0},  {"<i2", 2, values_of<std::int16_t>, 0},
    {"<i4", 4, values_of<std::int32_t>, 0},   {"<i8", 8, values_of<std::int64_t>, 0},
    {"<f4", 4, values_of<float>, 0},          {"<f8", 8, values_of<double>, 0}};
static_assert(std::endian::native == std::endian::little);

}  // namespace

Frames read_npy(const std::string& bytes) {
  const Header header = header_of(bytes);
  if (header.shape.size() != 2 && header.shape.size() != 3)
    throw std::runtime_error("must have two axes (rows, columns) or three (frames, rows, columns)");
  for (const auto& [name, size, values, full_scale] : types) {
    if (header.type != name) continue;
    double count = 1;
    for (const std::size_t length : header.shape) count *= static_cast<double>(length);
    if (static_cast<double>(bytes.size()) - static_cast<double>(header.begin) !=
        count * static_cast<double>(size))
      throw std::runtime_error("is a damaged NPY file");
    Frames frames{header.shape[header.shape.size() - 2], header.shape.back(),
                  values(std::string_view(bytes).substr(header.begin)), full_scale};
    if (header.by_columns)
      frames.values = row_by_row(frames.values, frames.count(), frames.rows, frames.columns);
    return frames;
  }
  throw std::runtime_error("has values of type " + header.type +
                           ", must be whole or floating-point numbers");
}

}  // namespace flatspeckle
