#include "core/session/shard_folder.h"

#include <iostream>
#include <vector>

#include "core/error.h"
#include "core/result/sealed_file.h"
#include "core/session/aside.h"
#include "core/session/identity.h"

namespace flatspeckle {

namespace fs = std::filesystem;

namespace {

/// Whose file it is, finished, unfinished or in the making (core/result/atomic_file.h); empty for
/// others.
std::string name_of(const fs::path& path) {
  std::string text = path.filename().string();
  if (const auto making = text.rfind(".tmp-"); text.starts_with('.') && making != text.npos)
    text = text.substr(1, making - 1);
  for (const std::string ending : {".part.h5", ".h5"})
    if (text.ends_with(ending)) return text.substr(0, text.size() - ending.size());
  return "";
}

}  // namespace

void ShardFolder::make() const {
  std::error_code failed;
  fs::create_directory(folder_, failed);
  if (failed || !fs::is_directory(folder_))
    throw IoError("cannot make the folder " + folder_.string() + ": " +
                  (failed ? failed.message() : "something else is there"));
}

fs::path ShardFolder::file(const std::string& name, Part part) const {
  return folder_ / (name + (part == Part::finished ? ".h5" : ".part.h5"));
}

bool ShardFolder::has(const std::string& name, Part part) const {
  return fs::exists(file(name, part));
}

std::optional<std::string> ShardFolder::read(
    const std::string& name, Part part, const std::string& identity,
    const std::function<void(const ResultReader&)>& reading) {
  const std::lock_guard lock(mutex_);
  const fs::path path = file(name, part);
  if (!is_sealed(path)) return "is damaged";
  try {
    const ResultReader reader(path);
    const auto found = reader.attribute<std::string>("/", "identity");
    if (found != identity)
      return "belongs to another sweep (" + first_difference(found, identity) + ')';
    reading(reader);
    return std::nullopt;
  } catch (const InputError& error) {
    return std::string("cannot be used (") + error.what() + ')';
  }
}

void ShardFolder::set_aside(const std::string& name, Part part, const std::string& wrong) {
  const fs::path path = file(name, part);
  const fs::path place = free_aside(path);
  std::error_code failed;
  fs::rename(path, place, failed);
  if (failed) throw IoError("renaming " + path.string() + " failed: " + failed.message());
  // In one piece: other threads may have something to say as well.
  std::cerr << "warning: " + path.string() + ' ' + wrong + "; set aside as " +
                   place.filename().string() + '\n';
}

void ShardFolder::write(const std::string& name, Part part, const std::string& identity,
                        Durable durable, const std::function<void(ResultFile&)>& contents) {
  const std::lock_guard lock(mutex_);
  ResultFile result(file(name, part));
  result.attribute("/", "identity", identity);
  contents(result);
  result.commit_sealed(durable);
  if (part == Part::finished) fs::remove(file(name, Part::unfinished));
}

std::set<std::string> ShardFolder::names() const {
  std::set<std::string> names;
  if (!fs::is_directory(folder_)) return names;
  for (const auto& entry : fs::directory_iterator(folder_)) names.insert(name_of(entry.path()));
  return names;
}

void ShardFolder::remove_unfinished(const std::string& name) const {
  std::error_code none;
  fs::remove(file(name, Part::unfinished), none);
}

void ShardFolder::remove(const std::set<std::string>& names) const {
  if (!fs::is_directory(folder_)) return;
  std::vector<fs::path> ours;
  for (const auto& entry : fs::directory_iterator(folder_))
    if (names.contains(name_of(entry.path()))) ours.push_back(entry.path());
  for (const fs::path& path : ours) {
    std::error_code failed;
    if (!fs::remove(path, failed) && failed)
      throw IoError("removing " + path.string() + " failed: " + failed.message());
  }
  std::error_code not_empty;
  fs::remove(folder_, not_empty);
}

}  // namespace flatspeckle
