#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace flatspeckle {

/// Where a file that is in the way is kept: the first of NAME.aside-1, NAME.aside-2 ... that is
/// free.
std::filesystem::path free_aside(const std::filesystem::path& path);

/// Gives a file such a name, by a second one beside its own where the file system can, so that the
/// first is never without a file; returns it. Throws IoError.
std::filesystem::path set_aside(const std::filesystem::path& path);

/// Tells one file at a path from another, or from itself rewritten.
struct FileStamp {
  std::uint64_t device, inode;
  std::int64_t seconds, nanoseconds;  ///< of its last change
  bool operator==(const FileStamp&) const = default;
};
/// Nothing where there is no file.
std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

}  // namespace flatspeckle
