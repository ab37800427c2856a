#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

namespace flatspeckle {

/// Appends a seal, 16 bytes that hold the length and the CRC-32 of those before. HDF5 does not mind
/// bytes after its own.
void seal(std::vector<std::byte>& bytes);
/// Returns the seal of a file on the disk, to be appended. Throws IoError where it cannot be read.
std::vector<std::byte> seal_of_file(const std::filesystem::path& path);

/// Whether the file ends in the seal of what comes before. False also where it cannot be read.
bool is_sealed(const std::filesystem::path& path);

/// HDF5 may crash, or never end, on a file that is damaged below its own format. Runs `read` in a
/// child process first, which has none of the caller's other threads, and throws InputError naming
/// the file where that dies or takes a minute of processor time. What `read` throws there is not
/// looked at: it will again.
void read_in_child(const std::filesystem::path& path, const std::function<void()>& read);

/// What read() returns, for files that no seal vouches for.
template <typename Read>
auto guarded_read(const std::filesystem::path& path, const Read& read) {
  read_in_child(path, [&] { read(); });
  return read();
}

}  // namespace flatspeckle
