#pragma once

#include <cstdint>
#include <filesystem>

namespace flatspeckle {

/// CRC-32 of all bytes of a file; 0 where it cannot be read.
std::uint32_t file_checksum(const std::filesystem::path& path);

}  // namespace flatspeckle
