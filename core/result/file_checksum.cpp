#include "core/result/file_checksum.h"

#include <array>
#include <fstream>
#include <zlib.h>

namespace flatspeckle {

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

}  // namespace flatspeckle
