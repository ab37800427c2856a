#include "core/keys/keys.h"

#include <algorithm>

namespace flatspeckle {

void Keys::remove(const std::string& name) {
  std::erase_if(rows_, [&](const Key& key) { return key.name() == name; });
}

void Keys::set(const std::string& name, const std::vector<std::string>& texts) const {
  for (const Key& key : rows_)
    if (key.name() == name) key.set(texts);
}

const Key* Keys::find(const std::string& name) const {
  const auto found =
      std::find_if(rows_.begin(), rows_.end(), [&](const Key& key) { return key.name() == name; });
  return found == rows_.end() ? nullptr : &*found;
}

const Key* Keys::row_of(const void* member) const {
  const auto found = std::find_if(rows_.begin(), rows_.end(),
                                  [&](const Key& key) { return key.address() == member; });
  return found == rows_.end() ? nullptr : &*found;
}

void Keys::check() const {
  for (const Key& key : rows_) key.check();
}

void Keys::require_set(const Key* key) {
  if (key != nullptr && key->value().empty())
    throw InputError(key->name() +
                     " is not given: " + (key->is_file() ? key->help() : key->accepted()));
}

/// Returns the cases in which a key applies, collected from all its definitions: "luneburg,
/// fisheye". Empty if one of the definitions applies in all cases.
std::string Keys::only_of(const std::string& name) const {
  std::string all;
  for (const Key& key : rows_) {
    if (key.name() != name) continue;
    if (key.only_of().empty()) return "";
    all += (all.empty() ? "" : ", ") + key.only_of();
  }
  return all;
}

void Keys::refuse_unread() const {
  for (const Key& key : rows_) {
    if (!key.given() || read_.contains(key.name())) continue;
    const std::string of = disregarded_.contains(key.name()) ? "" : only_of(key.name());
    throw InputError(key.name(), key.shown(),
                     of.empty() ? "is not used here; leave it out" : "is a key of " + of + " only");
  }
}

void Keys::merge_reads(const Keys& others) const {
  for (const auto& [name, row] : others.read_) read_.try_emplace(name, find(name));
}

std::string Keys::config(const std::set<std::string>& without) const {
  std::string text;
  for (const Key& key : rows_)
    if (key.is_in_files() && was_read(key) && !key.value().empty() && !without.contains(key.name()))
      text += key.line() + '\n';
  return text;
}

std::vector<std::string> Keys::files() const {
  std::vector<std::string> files;
  for (const Key& key : rows_)
    if (key.is_file() && was_read(key))
      for (const std::string& path : key.value()) files.push_back(path);
  return files;
}

/// Whether the key of this name was first read through this definition.
bool Keys::was_read(const Key& key) const {
  const auto row = read_.find(key.name());
  return row != read_.end() && row->second == &key;
}

std::string Keys::identity() const {
  std::set<std::string> effort;
  for (const Key& key : rows_)
    if (key.is_effort()) effort.insert(key.name());
  return config(effort);
}

}  // namespace flatspeckle
