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
    throw InputError(key->name() + " is not given: " + key->accepted());
}

/// "luneburg, fisheye", of all rows of a name; empty where one of them is for all.
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
    const std::string of = only_of(key.name());
    throw InputError(
        key.name(), key.shown(),
        of.empty() ? "nothing here has use for it; leave it out" : "is a key of " + of + " only");
  }
}

void Keys::join_reads(const Keys& others) const {
  read_.insert(others.read_.begin(), others.read_.end());
}

std::string Keys::config(const std::set<std::string>& without) const {
  std::set<std::string> left_out = without;
  std::string text;
  for (const Key& key : rows_)
    if (key.is_in_files() && read_.contains(key.name()) && !key.value().empty() &&
        left_out.insert(key.name()).second)
      text += key.line() + '\n';
  return text;
}

std::string Keys::identity() const {
  std::set<std::string> effort;
  for (const Key& key : rows_)
    if (key.is_effort()) effort.insert(key.name());
  return config(effort);
}

}  // namespace flatspeckle
