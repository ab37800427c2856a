#pragma once

#include <concepts>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/keys/key.h"

namespace flatspeckle {

/// Keys of one call and a record of which were read: keys that are given and never read are
/// rejected. Code that uses a struct's value reads it through the keys, so that the code that
/// decides what is used is the only place that says so. A forgotten read is seen at the first use
/// of its key; a condition in the row, if forgotten, would leave the key accepted and ignored.
/// Several rows may share a name (each kind of a thing has its own row for what it needs): a given
/// value goes to all of them and counts as read if one of them was.
class Keys {
 public:
  Keys() = default;
  Keys(const Keys&) = delete;  // rows are bound to members
  Keys& operator=(const Keys&) = delete;

  /// Of the rows that follow: their title in --help, and what they are keys of if not of all.
  void group(std::string title, std::string only_of = "") {
    group_ = std::move(title);
    only_of_ = std::move(only_of);
  }

  template <typename Member>
  Key& add(const std::string& name, Member& member, const std::string& help) {
    return rows_.emplace_back(name, &member, group_, help).only_of(only_of_);
  }
  void remove(const std::string& name);
  /// Fills every member of this name. Throws InputError.
  void set(const std::string& name, const std::vector<std::string>& texts) const;

  const std::deque<Key>& rows() const { return rows_; }
  /// nullptr where there is none.
  const Key* find(const std::string& name) const;
  /// nullptr of a member that this subcommand leaves at its value.
  const Key* row_of(const void* member) const;

  /// Value of a bound member, whose key then is read.
  template <typename Member>
  const Member& read(const Member& member) const {
    if (const Key* const key = row_of(&member)) read_.try_emplace(key->name(), key);
    return member;
  }
  /// The same, where there must be one. Throws InputError.
  template <typename Value>
  const Value& required(const std::optional<Value>& member) const {
    require_set(row_of(&member));
    return *read(member);
  }
  template <typename Value>
  requires requires(const Value& list) { list.empty(); }
  const Value& required(const Value& member) const {
    require_set(row_of(&member));
    return read(member);
  }
  /// What was read but turned out to have no say counts as not read.
  void disregard(const auto& member) const {
    if (const Key* const key = row_of(&member); key != nullptr && read_.erase(key->name()) > 0)
      disregarded_.insert(key->name());
  }
  bool given(const auto& member) const {
    const Key* const key = row_of(&member);
    return key != nullptr && key->given();
  }
  /// Of a member with a row, for messages.
  const std::string& name(const auto& member) const { return row_of(&member)->name(); }

  /// Throws InputError for the first value that its row does not accept.
  void check() const;
  /// Throws InputError for the first key that is given and was not read.
  void refuse_unread() const;
  /// Counts as read what others have read of keys of the same names.
  void join_reads(const Keys& others) const;

  /// The lines of a scene file that makes the same again: what was read, less some keys.
  std::string config(const std::set<std::string>& without = {}) const;
  /// Those of them that change the result.
  std::string identity() const;
  /// Those that were read, by their names there.
  std::vector<std::string> files() const;

 private:
  std::string only_of(const std::string& name) const;
  bool was_read(const Key& key) const;
  static void require_set(const Key* key);

  std::string group_, only_of_;
  std::deque<Key> rows_;
  mutable std::set<std::string> disregarded_;
  mutable std::map<std::string, const Key*> read_;  ///< the row of each name that was
};

/// A struct of values with keys of its own, given what differs from its defaults: how libraries
/// read a struct. add_keys(keys, values) is found by the struct's name.
template <typename Values>
struct Keyed {
  explicit Keyed(const Values& from) {
    add_keys(keys, values);
    values = from;
    keys.check();
  }
  Values values;
  Keys keys;
};

/// What `make` makes of values, all of which it must read. Throws InputError.
template <typename Values, typename Make>
auto made_of(const Values& values, const Make& make) {
  const Keyed<Values> keyed(values);
  auto made = make(keyed.keys, keyed.values);
  keyed.keys.refuse_unread();
  return made;
}

}  // namespace flatspeckle
