#include "core/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sstream>
#include <string>
#include <unistd.h>
#include <utility>

#include "core/error.h"

namespace flatspeckle {

namespace {

namespace fs = std::filesystem;

std::string reason() {
  return std::strerror(errno);
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

fs::path temporary_beside(const fs::path& path) {
  std::ostringstream name;
  name << '.' << path.filename().string() << ".tmp-" << ::getpid();
  return folder_of(path) / name.str();
}

/// A new file that is removed again unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& path)
      : path_(temporary_beside(path)),
        descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!is_open()) return;
    ::close(descriptor_);
    ::unlink(path_.c_str());
  }

  bool is_open() const { return descriptor_ >= 0; }

  bool write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ::ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno != EINTR) return false;
      if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return true;
  }

  /// From here on the file is no longer ours to remove.
  bool rename_to(const fs::path& path) {
    if (::fsync(descriptor_) != 0 || ::rename(path_.c_str(), path.c_str()) != 0) return false;
    return ::close(std::exchange(descriptor_, -1)) == 0;
  }

 private:
  fs::path path_;
  int descriptor_;
};

/// The new name itself survives a power failure only once its folder is on the disk.
bool sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return false;
  // Some file systems cannot sync folders and say EINVAL: nothing more can be done there.
  const bool synced = ::fsync(descriptor) == 0 || errno == EINVAL;
  ::close(descriptor);
  return synced;
}

}  // namespace

void check_writable(const fs::path& path) {
  if (!path.has_filename())
    throw InputError("cannot write \"" + path.string() + "\": no file name");
  std::error_code unknown;  // leaves it to the attempt below to complain
  if (fs::exists(path, unknown) && !fs::is_regular_file(path, unknown))
    throw InputError("cannot write " + path.string() + ": not a regular file");
  if (!TemporaryFile(path).is_open())
    throw InputError("cannot write " + path.string() + ": " + reason());
}

void replace_file(const fs::path& path, std::span<const std::byte> bytes) {
  TemporaryFile file(path);
  if (!file.is_open() || !file.write(bytes) || !file.rename_to(path) ||
      !sync_folder(folder_of(path)))
    throw IoError("writing " + path.string() + " failed: " + reason());
}

}  // namespace flatspeckle
