#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "core/run/interrupt.h"

namespace flatspeckle {

/// Returns where symbolic links lead from there, the path itself where it is none. Throws
/// InputError for a loop of them.
std::filesystem::path link_target(std::filesystem::path path);

/// Makes sure, before long work, that a file can be put at `path`; leaves nothing behind. Throws
/// InputError where the folder is missing or something that is no file is there, IoError where the
/// folder is closed to us, the file is write-protected or the disk is full.
void check_writable(const std::filesystem::path& path);

/// Removes the temporary files that killed processes have left beside `path`. For the process that
/// holds the lock of `path` alone.
void remove_temporary_files(const std::filesystem::path& path);

/// Whether a file that is in place must survive a failure of the machine, which takes some
/// milliseconds of waiting for the disk, or only that of this process.
enum class Durable { yes, no };

/// A file that grows beside `path` under a temporary name (.name.tmp-PID), and is removed again
/// unless it was put in place. Symbolic links are followed.
class FileBeside {
 public:
  /// Makes an empty one. Throws IoError.
  explicit FileBeside(std::filesystem::path path);
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;
  ~FileBeside();

  const std::filesystem::path& name() const { return temporary_; }
  void write(std::span<const std::byte> bytes);
  /// Writes at the end, after what was written by name.
  void append(std::span<const std::byte> bytes);
  /// Makes sure that so many bytes have room on the disk, or throws IoError.
  void reserve(std::uintmax_t bytes);
  /// Ends the file there, giving back what was reserved beyond.
  void truncate(std::uintmax_t bytes);
  /// Puts it at `path`, replacing what is there. Throws IoError.
  void put_in_place(Durable durable = Durable::yes);

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path path_, temporary_;
  RemovedIfEnded removed_;
  int descriptor_;
};

/// Puts `bytes` at `path` as a whole or not at all, also when the machine stops in between: written
/// by way of a FileBeside. Throws IoError, having removed the temporary file and left what was at
/// `path` before.
void replace_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                  Durable durable = Durable::yes);

}  // namespace flatspeckle
