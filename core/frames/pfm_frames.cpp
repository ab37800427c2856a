#include <bit>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "core/frames/frame_formats.h"

namespace flatspeckle {

/// The header has the letters Pf (PF for colours), columns, rows and a number that is negative if
/// the first byte of a value is the lowest. One blank ends it. Rows follow from the bottom to the
/// top.
Frames read_pfm(const std::string& bytes) {
  std::istringstream header(bytes.substr(2, 64));
  std::size_t columns = 0, rows = 0;
  double order = 0;
  constexpr std::size_t most = std::size_t{1} << 20;
  if (!(header >> columns >> rows >> order) || columns == 0 || rows == 0 || columns > most ||
      rows > most || order == 0)
    throw std::runtime_error("is a damaged PFM file");
  const std::size_t begin = 3 + static_cast<std::size_t>(header.tellg());
  const std::size_t channels = bytes.starts_with("PF") ? 3 : 1, line = channels * columns;
  if (bytes.size() != begin + 4 * rows * line)
    throw std::runtime_error("does not have 4 bytes for each of its pixels and colours");
  std::vector<double> values(rows * line);
  const bool swaps = (order < 0) != (std::endian::native == std::endian::little);
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < line; ++column) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, bytes.data() + begin + 4 * ((rows - 1 - row) * line + column), 4);
      if (swaps) bits = __builtin_bswap32(bits);
      values[row * line + column] = static_cast<double>(std::bit_cast<float>(bits));
    }
  return {rows, columns, grey_pixels(std::move(values), channels, 1), 0};
}

}  // namespace flatspeckle
