#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <zlib.h>

#include "core/frames/frame_formats.h"

// Layout: "OpenEXR File Layout", openexr.com/en/latest/OpenEXRFileLayout.html. All numbers are
// little endian.

namespace flatspeckle {

namespace {

[[noreturn]] void refuse_exr(const std::string& reason) {
  throw std::runtime_error(reason + ": " + accepted_pictures);
}

/// Reads numbers and texts of a file one after the other.
class ExrReader {
 public:
  ExrReader(const std::string& bytes, std::size_t at) : bytes_(bytes), at_(at) {}

  template <typename Number>
  Number next() {
    static_assert(std::endian::native == std::endian::little);
    Number number;
    std::memcpy(&number, skip(sizeof number), sizeof number);
    return number;
  }
  std::string name() {
    const std::size_t end = bytes_.find('\0', std::min(at_, bytes_.size()));
    if (end == bytes_.npos) refuse_exr("is a damaged OpenEXR file");
    const std::string text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return text;
  }
  const char* skip(std::size_t count) {
    if (at_ > bytes_.size() || count > bytes_.size() - at_) refuse_exr("is a damaged OpenEXR file");
    at_ += count;
    return bytes_.data() + at_ - count;
  }
  std::size_t at() const { return at_; }

 private:
  const std::string& bytes_;
  std::size_t at_;
};

enum ExrType : std::int32_t { exr_uint, exr_half, exr_float };
enum ExrCompression : std::uint8_t { exr_none, exr_rle, exr_zips, exr_zip };
/// Bound of the ratio by which a block is compressed (that of zlib), so that the sizes that damaged
/// files state need no memory.
constexpr std::size_t exr_most_ratio = 1040;

struct ExrChannel {
  std::int32_t type;
  double weight;  ///< of its values in the luminance
};

/// Content of the header that is used.
struct ExrHeader {
  std::vector<ExrChannel> channels;
  std::int32_t left = 0, top = 0, right = -1, bottom = -1;
  std::uint8_t compression = exr_none;
};

/// Weight of a channel in the luminance.
double weight_of(const std::string& channel) {
  if (channel == "Y") return 1;
  if (channel == "R") return luminance_weights[0];
  if (channel == "G") return luminance_weights[1];
  return channel == "B" ? luminance_weights[2] : 0;
}

std::vector<ExrChannel> channels_of(ExrReader& reader) {
  std::vector<ExrChannel> channels;
  std::string names;
  for (std::string name = reader.name(); !name.empty(); name = reader.name()) {
    const auto type = reader.next<std::int32_t>();
    reader.skip(4);
    const auto every_x = reader.next<std::int32_t>(), every_y = reader.next<std::int32_t>();
    if (type < exr_uint || type > exr_float || every_x != 1 || every_y != 1)
      refuse_exr("is an OpenEXR with channels of several sizes");
    channels.push_back({type, weight_of(name)});
    if (name != "A") names += name;
  }
  if (names != "Y" && names != "BGR")
    refuse_exr("is an OpenEXR without the channel Y alone, or R, G and B");
  return channels;
}

ExrHeader header_of(ExrReader& reader) {
  ExrHeader header;
  for (std::string name = reader.name(); !name.empty(); name = reader.name()) {
    reader.name();  // type
    const auto size = reader.next<std::int32_t>();
    const std::size_t begin = reader.at();
    if (name == "channels") {
      header.channels = channels_of(reader);
    } else if (name == "compression") {
      header.compression = reader.next<std::uint8_t>();
    } else if (name == "dataWindow") {
      for (std::int32_t* edge : {&header.left, &header.top, &header.right, &header.bottom})
        *edge = reader.next<std::int32_t>();
    }
    if (size < 0 || reader.at() > begin + static_cast<std::size_t>(size))
      refuse_exr("is a damaged OpenEXR file");
    reader.skip(begin + static_cast<std::size_t>(size) - reader.at());
  }
  if (header.compression > exr_zip) refuse_exr("is an OpenEXR of another compression");
  return header;
}

/// Returns the number of bytes of a line of pixels.
std::size_t line_size(const ExrHeader& header) {
  std::size_t pixel = 0;
  for (const ExrChannel& channel : header.channels) pixel += channel.type == exr_half ? 2 : 4;
  return pixel * static_cast<std::size_t>(std::int64_t{header.right} - header.left + 1);
}

double half_value(std::uint16_t bits) {
  constexpr int all_ones = 31;
  const int exponent = bits >> 10 & all_ones, fraction = bits & 1023;
  const double size = exponent == all_ones ? std::nan("")
                      : exponent == 0      ? std::ldexp(fraction, -24)
                                           : std::ldexp(1024 + fraction, exponent - 25);
  return bits >> 15 != 0 ? -size : size;
}

std::string inflated(std::string_view packed, std::size_t size) {
  std::string bytes(size, '\0');
  uLongf found = size;
  if (uncompress(reinterpret_cast<Bytef*>(bytes.data()), &found,
                 reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK ||
      found != size)
    refuse_exr("is a damaged OpenEXR file");
  return bytes;
}

/// Expands run lengths: a count n from 0 repeats the next byte n + 1 times, a count below 0
/// precedes -n bytes.
std::string run_lengths_expanded(std::string_view packed, std::size_t size) {
  std::string bytes;
  for (std::size_t at = 0; at < packed.size() && bytes.size() <= size;) {
    const int count = static_cast<signed char>(packed[at++]);
    const auto taken = static_cast<std::size_t>(count < 0 ? -count : 1);
    if (taken > packed.size() - at) break;
    if (count < 0)
      bytes += packed.substr(at, taken);
    else
      bytes.append(static_cast<std::size_t>(count) + 1, packed[at]);
    at += taken;
  }
  if (bytes.size() != size) refuse_exr("is a damaged OpenEXR file");
  return bytes;
}

/// Returns the content of a block of lines. Before compression, the bytes of even numbers are
/// placed before the others, and each byte is replaced by its difference to the one before. Blocks
/// that this does not shorten are stored as they are.
std::string exr_block(std::string_view packed, std::uint8_t compression, std::size_t size) {
  if (packed.size() == size) return std::string(packed);
  if (compression == exr_none || size / exr_most_ratio > packed.size())
    refuse_exr("is a damaged OpenEXR file");
  std::string bytes =
      compression == exr_rle ? run_lengths_expanded(packed, size) : inflated(packed, size);
  for (std::size_t i = 1; i < size; ++i)
    bytes[i] = static_cast<char>(bytes[i - 1] + bytes[i] - 128);
  std::string block(size, '\0');
  for (std::size_t i = 0; i < size; ++i)
    block[i] = bytes[i / 2 + (i % 2 == 0 ? 0 : (size + 1) / 2)];
  return block;
}

double exr_value(ExrReader& reader, std::int32_t type) {
  if (type == exr_half) return half_value(reader.next<std::uint16_t>());
  if (type == exr_float) return static_cast<double>(reader.next<float>());
  return reader.next<std::uint32_t>();
}

}  // namespace

Frames read_exr(const std::string& bytes) {
  constexpr std::uint32_t not_scan_lines = 0x1A00;  // tiles, deep data, several parts
  constexpr std::int64_t most = std::int64_t{1} << 20;
  ExrReader reader(bytes, 4);
  if ((reader.next<std::uint32_t>() & not_scan_lines) != 0)
    refuse_exr("is an OpenEXR of tiles, of deep data or of several parts");
  const ExrHeader header = header_of(reader);
  const std::int64_t columns = std::int64_t{header.right} - header.left + 1,
                     rows = std::int64_t{header.bottom} - header.top + 1;
  if (header.channels.empty() || columns < 1 || rows < 1 || columns > most || rows > most ||
      static_cast<std::size_t>(columns * rows) / exr_most_ratio > bytes.size())
    refuse_exr("is a damaged OpenEXR file");
  Frames frames{static_cast<std::size_t>(rows), static_cast<std::size_t>(columns), {}, 0};
  const std::int64_t most_lines = header.compression == exr_zip ? 16 : 1;
  for (std::int64_t first = 0; first < rows; first += most_lines) {
    const std::int64_t lines = std::min(most_lines, rows - first);
    ExrReader chunk(bytes, reader.next<std::uint64_t>());
    if (chunk.next<std::int32_t>() != header.top + first) refuse_exr("is a damaged OpenEXR file");
    const auto packed_size = static_cast<std::size_t>(chunk.next<std::int32_t>());
    const std::string block = exr_block({chunk.skip(packed_size), packed_size}, header.compression,
                                        static_cast<std::size_t>(lines) * line_size(header));
    ExrReader values(block, 0);
    frames.values.resize(static_cast<std::size_t>((first + lines) * columns));
    double* line = &frames.values[static_cast<std::size_t>(first * columns)];
    for (std::int64_t i = 0; i < lines; ++i, line += columns)
      for (const ExrChannel& channel : header.channels)
        for (std::int64_t column = 0; column < columns; ++column)
          line[column] += channel.weight * exr_value(values, channel.type);
  }
  return frames;
}

}  // namespace flatspeckle
