#include "core/session/aside.h"

#include <string>
#include <sys/stat.h>

#include "core/error.h"

namespace flatspeckle {

std::filesystem::path free_aside(const std::filesystem::path& path) {
  for (int number = 1;; ++number) {
    const std::filesystem::path place = path.string() + ".aside-" + std::to_string(number);
    if (!std::filesystem::exists(place)) return place;
  }
}

std::filesystem::path set_aside(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  const fs::path place = free_aside(path);
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

}  // namespace flatspeckle
