#include "core/session/output_lock.h"

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
#include "core/run/interrupt.h"

namespace flatspeckle {

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
  return length > 0 ? std::string(text.data()) : std::string("that does not say its name");
}

/// For people: the lock holds without. Open no longer than that, or no disk could be made
/// read-only.
void say_owner(const fs::path& lock) {
  std::ofstream(lock) << this_process();
}

/// Not so where the process that held it has just removed it.
bool is_still_there(int descriptor, const fs::path& path) {
  struct ::stat held {};
  struct ::stat found {};
  return ::fstat(descriptor, &held) == 0 && ::stat(path.c_str(), &found) == 0 &&
         held.st_ino == found.st_ino && held.st_dev == found.st_dev;
}

}  // namespace

OutputLock::OutputLock(const std::filesystem::path& out) : path_(lock_beside(out)) {
  while (!take(out)) {
  }
}

/// False where it is to be tried again.
bool OutputLock::take(const std::filesystem::path& out) {
  const EndsLater whole;
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) return true;
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const bool taken = errno == EWOULDBLOCK;
    const std::string owner = content(descriptor_);
    ::close(std::exchange(descriptor_, -1));
    if (taken)
      throw InputError("out", out.string(),
                       "process " + owner + " works on it; wait for its end, or name another file");
    return true;
  }
  if (!is_still_there(descriptor_, path_)) {
    ::close(std::exchange(descriptor_, -1));
    return false;
  }
  removed_.emplace(path_.string());
  say_owner(path_);
  return true;
}

OutputLock::~OutputLock() {
  if (descriptor_ < 0) return;
  const EndsLater whole;
  removed_.reset();
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

}  // namespace flatspeckle
