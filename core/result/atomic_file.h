#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "core/run/interrupt.h"

namespace flatspeckle {

/// Follows symbolic links and returns the final target; returns the path itself if it is not a
/// link. Throws InputError for a loop of links.
std::filesystem::path link_target(std::filesystem::path path);

/// Checks that a file can be written to `path`, so that errors are found before long work; leaves
/// no file behind. Throws InputError if the folder is missing or `path` is not a regular file,
/// IoError if the folder is not writable, the file is write-protected or the disk is full.
void check_writable(const std::filesystem::path& path);

/// Removes temporary files for `path` (see FileBeside) that killed processes have left. Only the
/// process that holds the lock of `path` may call this.
void remove_temporary_files(const std::filesystem::path& path);

/// Whether a written file must survive a crash of the machine (yes), which requires some
/// milliseconds of waiting for the disk, or only a crash of this process (no).
enum class Durable { yes, no };

/// File that is written under a temporary name (.name.tmp-PID) in the folder of `path`.
/// put_in_place() renames it to `path`; otherwise the destructor removes it. Symbolic links are
/// followed.
class FileBeside {
 public:
  /// Creates an empty file under the temporary name. Throws IoError.
  explicit FileBeside(std::filesystem::path path);
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;
  ~FileBeside();

  const std::filesystem::path& name() const { return temporary_; }
  void write(std::span<const std::byte> bytes);
  /// Appends bytes to the file, also if another library (HDF5) has written to it under its
  /// temporary name.
  void append(std::span<const std::byte> bytes);
  /// Reserves this number of bytes on the disk for the file. Throws IoError if the disk is full.
  void reserve(std::uintmax_t bytes);
  /// Truncates the file to this length and releases the space that was reserved beyond it.
  void truncate(std::uintmax_t bytes);
  /// Renames the file to `path`, replacing any existing file. Throws IoError.
  void put_in_place(Durable durable = Durable::yes);

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path path_, temporary_;
  RemovedIfEnded removed_;
  int descriptor_;
};

/// Writes `bytes` to the file `path` through a FileBeside, so that the file is either complete or
/// unchanged, even if the machine crashes. Throws IoError; an existing file at `path` is then kept.
void replace_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                  Durable durable = Durable::yes);

}  // namespace flatspeckle
