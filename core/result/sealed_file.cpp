#include "core/result/sealed_file.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <zlib.h>

namespace flatspeckle {

namespace {

struct Seal {
  std::array<char, 4> word;
  std::uint32_t checksum;
  std::uint64_t length;
};
static_assert(sizeof(Seal) == 16);

Seal seal_of(const std::byte* bytes, std::size_t length) {
  const auto checksum = crc32_z(0, reinterpret_cast<const unsigned char*>(bytes), length);
  return {{'s', 'e', 'a', 'l'}, static_cast<std::uint32_t>(checksum), length};
}

}  // namespace

void seal(std::vector<std::byte>& bytes) {
  const Seal seal = seal_of(bytes.data(), bytes.size());
  const auto* first = reinterpret_cast<const std::byte*>(&seal);
  bytes.insert(bytes.end(), first, first + sizeof seal);
}

bool is_sealed(const std::filesystem::path& path) {
  std::error_code none;
  const auto size = std::filesystem::file_size(path, none);
  if (none || size < sizeof(Seal)) return false;
  std::vector<std::byte> bytes(size);
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    return false;
  const std::size_t length = bytes.size() - sizeof(Seal);
  const Seal expected = seal_of(bytes.data(), length);
  return std::memcmp(&expected, bytes.data() + length, sizeof(Seal)) == 0;
}

}  // namespace flatspeckle
