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

/// Keys of one call of the program. Each key sets a variable, and code reads the variable through
/// this class, which records that the key was read. A key that the user gives but no code reads has
/// no effect and is rejected. Several definitions (rows) may share a name, for example one for each
/// kind of scatterer: a given value then sets the variables of all these definitions, and the key
/// counts as read if one of the variables was read.
class Keys {
 public:
  Keys() = default;
  Keys(const Keys&) = delete;  // the keys contain pointers to variables
  Keys& operator=(const Keys&) = delete;

  /// Sets the heading in --help of the keys that are added next, and in which cases these keys
  /// apply, if not in all.
  void group(std::string title, std::string only_of = "") {
    group_ = std::move(title);
    only_of_ = std::move(only_of);
  }

  template <typename Member>
  Key& add(const std::string& name, Member& member, const std::string& help) {
    return rows_.emplace_back(name, &member, group_, help).only_of(only_of_);
  }
  void remove(const std::string& name);
  /// Sets the variables of all definitions of the key of this name. Throws InputError for values
  /// that are not accepted.
  void set(const std::string& name, const std::vector<std::string>& texts) const;

  const std::deque<Key>& rows() const { return rows_; }
  /// Returns the first definition of the key of this name; nullptr if there is none.
  const Key* find(const std::string& name) const;
  /// Returns the definition of the key that sets the variable at this address; nullptr if there is
  /// none.
  const Key* row_of(const void* member) const;

  /// Returns the variable, after marking the key that sets it as read.
  template <typename Member>
  const Member& read(const Member& member) const {
    if (const Key* const key = row_of(&member)) read_.try_emplace(key->name(), key);
    return member;
  }
  /// Returns the value of an optional variable, after marking its key as read. Throws InputError if
  /// the variable is not set.
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
  /// Marks a key as not read, because its value turned out to have no effect.
  void disregard(const auto& member) const {
    if (const Key* const key = row_of(&member); key != nullptr && read_.erase(key->name()) > 0)
      disregarded_.insert(key->name());
  }
  bool given(const auto& member) const {
    const Key* const key = row_of(&member);
    return key != nullptr && key->given();
  }
  /// Returns the name of the key that sets the variable, for messages.
  const std::string& name(const auto& member) const { return row_of(&member)->name(); }

  /// Throws InputError for the first key whose value is not accepted.
  void check() const;
  /// Throws InputError for the first key that is given and was not read.
  void refuse_unread() const;
  /// Marks as read all keys that were read under the same name in `others`.
  void merge_reads(const Keys& others) const;

  /// Returns a scene file that reproduces this call: the lines of all keys that were read, except
  /// `without`.
  std::string config(const std::set<std::string>& without = {}) const;
  /// Returns the lines of config() for keys that change the result; keys marked by Key::effort() do
  /// not.
  std::string identity() const;
  /// Returns the paths of the input files: the values of all keys marked by Key::file() that were
  /// read.
  std::vector<std::string> files() const;

 private:
  std::string only_of(const std::string& name) const;
  bool was_read(const Key& key) const;
  static void require_set(const Key* key);

  std::string group_, only_of_;
  std::deque<Key> rows_;
  mutable std::set<std::string> disregarded_;
  mutable std::map<std::string, const Key*>
      /// For the name of each key that was read, the definition through which it was read.
      read_;
};

/// Copy of a struct of values, together with keys that set its members, for library functions that
/// read values through keys. Values that differ from the defaults count as given. The keys are
/// added by the function add_keys(keys, values) in the namespace of the struct.
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

/// Returns make(keys, values). Throws InputError if `make` does not read a value that differs from
/// its default.
template <typename Values, typename Make>
auto made_of(const Values& values, const Make& make) {
  const Keyed<Values> keyed(values);
  auto made = make(keyed.keys, keyed.values);
  keyed.keys.refuse_unread();
  return made;
}

}  // namespace flatspeckle
