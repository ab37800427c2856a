#include "core/session/output_file.h"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "core/error.h"
#include "core/result/atomic_file.h"

namespace flatspeckle {

std::filesystem::path free_backup(const std::filesystem::path& path) {
  for (int number = 1;; ++number) {
    const std::filesystem::path place = path.string() + ".aside-" + std::to_string(number);
    if (!std::filesystem::exists(place)) return place;
  }
}

std::filesystem::path back_up(const std::filesystem::path& given) {
  namespace fs = std::filesystem;
  const fs::path path = link_target(given), place = free_backup(path);
  std::error_code failed;
  fs::create_hard_link(path, place, failed);
  if (failed) fs::rename(path, place, failed);
  if (failed) throw IoError("renaming " + path.string() + " failed: " + failed.message());
  return place;
}

std::optional<FileStamp> stamp_of(const std::filesystem::path& path) {
  struct ::stat found {};
  if (::stat(path.c_str(), &found) != 0) return std::nullopt;
  return FileStamp{found.st_dev, found.st_ino, found.st_mtim.tv_sec, found.st_mtim.tv_nsec};
}

namespace {

namespace fs = std::filesystem;

fs::path lock_beside(const fs::path& out) {
  std::ostringstream name;
  name << '.' << out.filename().string() << ".lock";
  return out.parent_path() / name.str();
}

std::string this_process() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return std::to_string(::getpid()) + " on " + host.data();
}

std::string content(int descriptor) {
  std::array<char, 300> text{};
  const ::ssize_t length = ::pread(descriptor, text.data(), text.size() - 1, 0);
  return length > 0 ? std::string(text.data()) : std::string("(unknown)");
}

/// Writes process and machine into the lock file, for error messages only; the lock does not depend
/// on this text. The file is closed at once, because a file open for writing prevents the disk from
/// being made read-only.
void write_owner(const fs::path& lock) {
  std::ofstream(lock) << this_process();
}

/// Whether the opened lock file still exists at its path; the process that held the lock may just
/// have removed it.
bool is_still_there(int descriptor, const fs::path& path) {
  struct ::stat held {};
  struct ::stat found {};
  return ::fstat(descriptor, &held) == 0 && ::stat(path.c_str(), &found) == 0 &&
         held.st_ino == found.st_ino && held.st_dev == found.st_dev;
}

}  // namespace

OutputLock::OutputLock(const std::filesystem::path& out) : path_(lock_beside(link_target(out))) {
  while (!take(out)) {
  }
  if (descriptor_ >= 0) remove_temporary_files(link_target(out));
}

/// Tries to lock the output file. Returns false if the caller must try again, because the lock file
/// has been removed meanwhile.
bool OutputLock::take(const std::filesystem::path& out) {
  const DelayedTermination whole;
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) return true;
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const bool taken = errno == EWOULDBLOCK;
    const std::string owner = content(descriptor_);
    ::close(std::exchange(descriptor_, -1));
    if (taken)
      throw InputError(
          "out", out.string(),
          "process " + owner + " works on it; wait until it ends, or name another file");
    return true;
  }
  if (!is_still_there(descriptor_, path_)) {
    ::close(std::exchange(descriptor_, -1));
    return false;
  }
  removed_.emplace(path_.string());
  write_owner(path_);
  return true;
}

OutputLock::~OutputLock() {
  if (descriptor_ < 0) return;
  const DelayedTermination whole;
  removed_.reset();
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

}  // namespace flatspeckle
