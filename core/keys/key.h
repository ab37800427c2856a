#pragma once

#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace flatspeckle {

/// What a key fills: a number, a text, a list of either, or a switch. What is optional and has no
/// value, an empty text and an empty list are not set.
using KeyMember =
    std::variant<bool*, std::int64_t*, double*, std::string*, std::optional<std::int64_t>*,
                 std::optional<double>*, std::optional<std::string>*, std::vector<double>*,
                 std::vector<std::int64_t>*, std::vector<std::string>*>;

/// The one row of a key: name, the member that it fills, what it accepts, and in words what it is.
/// The member's value when the row is made is the default. Ranges hold for each number of a list.
class Key {
 public:
  Key(std::string name, KeyMember member, std::string group, std::string help);

  // What is accepted; without any of these a number must be finite, and a text is free.
  Key& positive() { return between(0, infinity); }
  Key& not_negative() { return from(0, infinity); }
  /// Both included.
  Key& from(double low, double high) { return with(range_, {low, high, false, false}); }
  /// Neither included.
  Key& between(double low, double high) { return with(range_, {low, high}); }
  /// high included.
  Key& positive_to(double high) { return with(range_, {0, high, true, false}); }
  /// Radians: who writes 45 means degrees.
  Key& angle() { return from(-2 * std::numbers::pi, 2 * std::numbers::pi).unit("rad"); }
  Key& one_of(std::vector<std::string> words) { return with(words_, std::move(words)); }
  /// What became of words that are accepted no more: ends the line that refuses a word.
  Key& gone(std::string text) { return with(gone_, std::move(text)); }
  /// So many numbers for each thing, in words.
  Key& each_of(std::size_t numbers, std::string what) {
    return with(each_, numbers).with(shape_, std::move(what));
  }
  /// Exactly so many, in words.
  Key& exactly(std::size_t numbers, std::string what) {
    return with(exactly_, numbers).with(shape_, std::move(what));
  }
  // What else is known of it.
  Key& unit(std::string text) { return with(unit_, std::move(text)); }
  /// What it is a key of, where not everything reads it: "soft, hard, tm and te".
  Key& only_of(std::string what) { return with(only_of_, std::move(what)); }
  /// How long or on what to run, not what: no part of a result's identity.
  Key& effort() { return with(effort_, true); }
  Key& no_file() { return with(in_files_, false); }  ///< on the command line alone
  Key& swept() { return with(swept_, true); }        ///< a sweep may take many values
  /// Names a file, which must be there: its content is asked for as well.
  Key& file() { return with(file_, true); }

  const std::string& name() const { return name_; }
  const std::string& group() const { return group_; }
  const std::string& unit() const { return unit_; }
  const std::string& only_of() const { return only_of_; }
  const std::vector<std::string>& words() const { return words_; }
  bool is_effort() const { return effort_; }
  bool is_in_files() const { return in_files_; }
  bool is_swept() const { return swept_; }
  bool is_file() const { return file_; }
  bool is_list() const;
  bool is_switch() const { return std::holds_alternative<bool*>(member_); }
  bool is_whole() const;  ///< whole numbers
  bool is_number() const;
  const void* address() const;

  /// The line of --help: with unit, words and what it is a key of.
  std::string help() const;
  /// "must be positive".
  std::string accepted() const;

  /// Numbers in the shortest form that reads back as the same one; nothing where it is not set.
  std::vector<std::string> value() const;
  const std::vector<std::string>& default_value() const { return default_; }
  /// What is given is other than the default: a resolved scene, which names all, gives no more than
  /// the one that it came from.
  bool given() const { return value() != default_; }
  /// "1 2 3", for messages.
  std::string shown() const;
  /// "key = value" of a scene file.
  std::string line() const;

  /// Both throw InputError naming key, value and what is accepted.
  void set(const std::vector<std::string>& texts) const;
  void check() const;

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  struct Range {
    double low = -infinity, high = infinity;
    bool low_open = true, high_open = true;

    bool has(double value) const;
    /// "must be positive", of whole numbers or any.
    std::string text(bool whole) const;
  };
  std::string range() const;

  template <typename Value>
  Key& with(Value& member, std::type_identity_t<Value> value) {
    member = std::move(value);
    return *this;
  }
  void check(double value, const std::string& shown) const;

  std::string name_, group_, help_, unit_, only_of_, shape_, gone_;
  KeyMember member_;
  std::vector<std::string> default_, words_;
  Range range_;
  bool effort_ = false, in_files_ = true, swept_ = false, file_ = false;
  std::size_t each_ = 0, exactly_ = 0;
};

}  // namespace flatspeckle
