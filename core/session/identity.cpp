#include "core/session/identity.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <zlib.h>

namespace flatspeckle {

namespace {

/// CRC-32 of all bytes of a file; 0 where it cannot be read.
std::uint32_t file_checksum(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 1 << 16> part;
  uLong checksum = 0;
  do {
    file.read(part.data(), part.size());
    checksum = crc32_z(checksum, reinterpret_cast<const unsigned char*>(part.data()),
                       static_cast<z_size_t>(file.gcount()));
  } while (file);
  return static_cast<std::uint32_t>(checksum);
}

}  // namespace

std::string first_difference(const std::string& there, const std::string& here) {
  std::istringstream ours(here), lines(there);
  std::set<std::string> known;
  for (std::string line; std::getline(ours, line);) known.insert(line);
  for (std::string line; std::getline(lines, line);)
    if (!known.contains(line)) return line;
  return "fewer keys";
}

std::string inputs_text(const Keys& keys) {
  std::string text;
  for (const std::string& path : keys.files())
    text += path + ' ' + std::to_string(file_checksum(path)) + '\n';
  return text;
}

}  // namespace flatspeckle
