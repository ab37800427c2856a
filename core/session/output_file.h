#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/run/interrupt.h"

namespace flatspeckle {

/// Returns the name for a backup of a file: the first of NAME.aside-1, NAME.aside-2 ... that is
/// free.
std::filesystem::path free_backup(const std::filesystem::path& path);

/// Backs up a file, or the target of a symbolic link, under the name of free_backup(), and returns
/// this name. If the file system supports hard links, the backup is one, so that the file always
/// exists under its original name. Throws IoError.
std::filesystem::path back_up(const std::filesystem::path& path);

/// Properties of the file at a path, by which it is detected that the file was replaced or
/// rewritten.
struct FileStamp {
  std::uint64_t device, inode;
  std::int64_t seconds, nanoseconds;  ///< time of the last change of the file
  bool operator==(const FileStamp&) const = default;
};
/// Returns the stamp of the file at a path; nullopt if there is no file.
std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

/// Lock that limits an output file to one process at a time. The file .NAME.lock in the same folder
/// (for a symbolic link, in the folder of its target) is locked, until the process ends for
/// whatever reason. If the file system does not support locks, nothing is locked. The constructor
/// removes temporary files of the output that killed processes have left.
class OutputLock {
 public:
  /// Throws InputError naming the process that has locked the output.
  explicit OutputLock(const std::filesystem::path& out);
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;
  ~OutputLock();

 private:
  bool take(const std::filesystem::path& out);

  std::filesystem::path path_;
  std::optional<RemovedIfEnded> removed_;
  int descriptor_ = -1;
};

}  // namespace flatspeckle
