#pragma once

#include <filesystem>
#include <optional>

#include "core/run/interrupt.h"

namespace flatspeckle {

/// Keeps an output to one process at a time, by a lock on .NAME.lock beside it that ends with the
/// process however that ends. Where the file system has no locks there is none.
class OutputLock {
 public:
  /// Throws InputError, which names the process that has the output.
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
