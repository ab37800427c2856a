#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "core/frames/frame_formats.h"

// Format: "Radiance File Formats", section on pictures,
// radsite.lbl.gov/radiance/refer/filefmts.pdf.

namespace flatspeckle {

namespace {

[[noreturn]] void refuse_hdr(const std::string& reason) {
  throw std::runtime_error(reason + ": " + accepted_pictures);
}

[[noreturn]] void refuse_damaged_hdr() {
  refuse_hdr("is a damaged Radiance HDR");
}

/// Content of the header that is used.
struct HdrHeader {
  std::size_t rows = 0, columns = 0;
  double exposure = 1;  ///< factor by which the pixels were multiplied
};

/// Removes a line of text from the rest of a file and returns it.
std::string next_hdr_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  if (end == rest.npos) refuse_damaged_hdr();
  const std::string line(rest.substr(0, end));
  rest.remove_prefix(end + 1);
  return line;
}

/// Reads the lines of text before the pixels: variables, an empty line, and the size.
HdrHeader hdr_header(std::string_view& rest) {
  constexpr std::size_t most = std::size_t{1} << 20;
  HdrHeader header;
  std::string format, y, x;
  for (std::string line = next_hdr_line(rest); !line.empty(); line = next_hdr_line(rest)) {
    if (line.starts_with("FORMAT=")) format = line.substr(7);
    if (line.starts_with("EXPOSURE=")) header.exposure *= std::strtod(line.c_str() + 9, nullptr);
  }
  if (format != "32-bit_rle_rgbe") refuse_hdr("is a Radiance HDR without FORMAT=32-bit_rle_rgbe");
  std::istringstream size(next_hdr_line(rest));
  if (!(size >> y >> header.rows >> x >> header.columns) || header.rows == 0 ||
      header.columns == 0 || header.rows > most || header.columns > most ||
      !(header.exposure > 0 && std::isfinite(header.exposure)))
    refuse_damaged_hdr();
  if (y != "-Y" || x != "+X")
    refuse_hdr("is a Radiance HDR with lines in another order than -Y N +X N");
  return header;
}

/// Reads lines of pixels one after the other.
class HdrReader {
 public:
  explicit HdrReader(std::string_view bytes) : rest_(bytes) {}

  /// Reads a line: red, green, blue and exponent of each pixel, or the run lengths of all of its
  /// reds, greens, blues and exponents.
  void read(std::vector<std::uint8_t>& line, std::size_t columns) {
    constexpr std::size_t least = 8, most = 32767;
    const bool is_packed = columns >= least && columns <= most && rest_.size() >= 4 &&
                           rest_[0] == 2 && rest_[1] == 2 && (rest_[2] & 0x80) == 0;
    if (!is_packed) {
      for (std::uint8_t& byte : line) byte = next();
      return;
    }
    next(), next();
    if (const std::size_t high = next(); 256 * high + next() != columns) refuse_damaged_hdr();
    for (std::size_t channel = 0; channel < 4; ++channel) expand(&line[channel], columns);
  }

 private:
  std::uint8_t next() {
    if (rest_.empty()) refuse_damaged_hdr();
    const auto byte = static_cast<std::uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    return byte;
  }
  /// Expands run lengths: a count above 128 repeats the next byte count - 128 times, another one
  /// precedes as many bytes.
  void expand(std::uint8_t* channel, std::size_t columns) {
    for (std::size_t column = 0; column < columns;) {
      const std::size_t count = next(), length = count > 128 ? count - 128 : count;
      if (length == 0 || length > columns - column) refuse_damaged_hdr();
      const std::size_t end = column + length;
      for (std::uint8_t value = 0; column < end; ++column) {
        if (count <= 128 || column + length == end) value = next();
        channel[4 * column] = value;
      }
    }
  }

  std::string_view rest_;
};

}  // namespace

/// A pixel has bytes of red, green and blue and their common exponent.
Frames read_hdr(const std::string& bytes) {
  constexpr std::size_t most_ratio = 64;  // of run lengths
  std::string_view rest = bytes;
  const HdrHeader header = hdr_header(rest);
  if (header.rows * header.columns / most_ratio > rest.size()) refuse_damaged_hdr();
  HdrReader reader(rest);
  Frames frames{header.rows, header.columns, {}, 0};
  std::vector<std::uint8_t> line(4 * header.columns);
  for (std::size_t row = 0; row < header.rows; ++row) {
    reader.read(line, header.columns);
    for (std::size_t column = 0; column < header.columns; ++column) {
      const std::uint8_t* pixel = &line[4 * column];
      if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1)
        refuse_hdr("is a Radiance HDR with run lengths of its first version");
      double luminance = 0;
      for (int c = 0; c < 3; ++c) luminance += luminance_weights[c] * pixel[c];
      frames.values.push_back(
          pixel[3] == 0 ? 0 : std::ldexp(luminance, pixel[3] - 136) / header.exposure);
    }
  }
  return frames;
}

}  // namespace flatspeckle
