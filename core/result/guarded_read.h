#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

namespace flatspeckle {

/// Appends a checksum record of 16 bytes to the bytes of a file: their length and CRC-32. HDF5
/// ignores bytes after its own data.
void append_checksum(std::vector<std::byte>& bytes);
/// Returns the checksum record of a file on the disk, to be appended to the file. Throws IoError if
/// the file cannot be read.
std::vector<std::byte> checksum_of_file(const std::filesystem::path& path);

/// Whether the file ends with a checksum record that matches the bytes before it. Returns false if
/// the file cannot be read.
bool is_checksummed(const std::filesystem::path& path);

/// Tries `read` in a child process, because HDF5 may crash or hang on a damaged file. Throws
/// InputError, which names the file, if the child crashes or uses a minute of processor time.
/// Exceptions thrown by `read` in the child are ignored, because they occur again when the caller
/// reads the file.
void read_in_child(const std::filesystem::path& path, const std::function<void()>& read);

/// Returns read(), after trying it in a child process; for files without a checksum record.
template <typename Read>
auto guarded_read(const std::filesystem::path& path, const Read& read) {
  read_in_child(path, [&] { read(); });
  return read();
}

}  // namespace flatspeckle
