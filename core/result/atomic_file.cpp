#include "core/result/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <unistd.h>
#include <utility>

#include "core/error.h"

namespace flatspeckle {

namespace {

namespace fs = std::filesystem;

std::string reason(int error = errno) {
  return std::strerror(error);
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Returns the beginning of the names of temporary files for `path`, which end with a process
/// number.
std::string temporary_name(const fs::path& path) {
  return '.' + path.filename().string() + ".tmp-";
}

fs::path temporary_beside(const fs::path& path) {
  return folder_of(path) / (temporary_name(path) + std::to_string(::getpid()));
}

int create(const fs::path& path) {
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

/// Whether an existing file is write-protected by its permissions, which are respected even for the
/// superuser.
bool is_protected(const fs::path& path) {
  constexpr fs::perms write =
      fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  std::error_code none;
  return (fs::status(path, none).permissions() & write) == fs::perms::none ||
         ::access(path.c_str(), W_OK) != 0;
}

/// Writes a folder to the disk, which is necessary for a new file name in it to survive a power
/// failure.
bool sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return false;
  // Some file systems cannot do this and report EINVAL, which is ignored.
  const bool synced = ::fsync(descriptor) == 0 || errno == EINVAL;
  ::close(descriptor);
  return synced;
}

}  // namespace

fs::path link_target(fs::path path) {
  constexpr int most_links = 40;
  std::error_code none;
  for (int links = 0; fs::is_symlink(path, none); ++links) {
    if (links == most_links)
      throw InputError("cannot write " + path.string() + ": a loop of symbolic links");
    const fs::path target = fs::read_symlink(path, none);
    path = target.is_absolute() ? target : folder_of(path) / target;
  }
  return path;
}

void remove_temporary_files(const fs::path& path) {
  const std::string begin = temporary_name(path);
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder_of(path), none))
    if (const std::string name = entry.path().filename().string();
        name.starts_with(begin) && name.find_first_not_of("0123456789", begin.size()) == name.npos)
      fs::remove(entry.path(), none);
}

void check_writable(const fs::path& given) {
  if (!given.has_filename())
    throw InputError("cannot write \"" + given.string() + "\": no file name");
  const fs::path path = link_target(given);
  std::error_code unknown;  // ignored, because the attempt to write below reports errors
  if (fs::exists(path, unknown) && !fs::is_regular_file(path, unknown))
    throw InputError("cannot write " + path.string() + ": not a regular file");
  if (fs::exists(path, unknown) && is_protected(path))
    throw IoError("cannot write " + path.string() + ": it is write-protected");
  const fs::path temporary = temporary_beside(path);
  const DelayedTermination whole;
  const int descriptor = create(temporary);
  if (descriptor < 0) {
    const std::string message = "cannot write " + path.string() + ": " + reason();
    if (errno == ENOENT || errno == ENOTDIR || errno == ENAMETOOLONG) throw InputError(message);
    throw IoError(message);
  }
  ::close(descriptor);
  ::unlink(temporary.c_str());
}

FileBeside::FileBeside(fs::path path)
    : path_(link_target(std::move(path))),
      temporary_(temporary_beside(path_)),
      removed_(temporary_.string()),
      descriptor_(create(temporary_)) {
  if (descriptor_ < 0) fail(errno);
}

FileBeside::~FileBeside() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

void FileBeside::fail(int error) const {
  throw IoError("writing " + path_.string() + " failed: " + reason(error));
}

void FileBeside::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ::ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) fail(errno);
    if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void FileBeside::append(std::span<const std::byte> bytes) {
  if (::lseek(descriptor_, 0, SEEK_END) < 0) fail(errno);
  write(bytes);
}

void FileBeside::reserve(std::uintmax_t bytes) {
  const int error = ::posix_fallocate(descriptor_, 0, static_cast<::off_t>(bytes));
  // Some file systems cannot reserve space; a full disk is then detected later, when data is
  // written.
  if (error != 0 && error != EOPNOTSUPP && error != EINVAL) fail(error);
}

void FileBeside::truncate(std::uintmax_t bytes) {
  if (::ftruncate(descriptor_, static_cast<::off_t>(bytes)) != 0) fail(errno);
}

void FileBeside::put_in_place(Durable durable) {
  const bool sync = durable == Durable::yes;
  const DelayedTermination whole;
  if ((sync && ::fsync(descriptor_) != 0) || ::rename(temporary_.c_str(), path_.c_str()) != 0)
    fail(errno);
  // The file now has its final name, and the destructor must not remove it.
  if (::close(std::exchange(descriptor_, -1)) != 0 || (sync && !sync_folder(folder_of(path_))))
    fail(errno);
}

void replace_file(const fs::path& path, std::span<const std::byte> bytes, Durable durable) {
  FileBeside file(path);
  file.write(bytes);
  file.put_in_place(durable);
}

}  // namespace flatspeckle
