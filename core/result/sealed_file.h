#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace flatspeckle {

/// Appends a seal, 16 bytes that hold the length and the CRC-32 of those before. HDF5 does not mind
/// bytes after its own.
void seal(std::vector<std::byte>& bytes);

/// Whether the file ends in the seal of what comes before. False also where it cannot be read.
bool is_sealed(const std::filesystem::path& path);

}  // namespace flatspeckle
