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

#include "core/keys/unit.h"

namespace flatspeckle {

/// Pointer to the variable that a key sets: a number, a text, a list of numbers or texts, or a
/// switch. An optional without a value, an empty text and an empty list count as not set.
using KeyMember =
    std::variant<bool*, std::int64_t*, double*, std::string*, std::optional<std::int64_t>*,
                 std::optional<double>*, std::optional<std::string>*, std::vector<double>*,
                 std::vector<std::int64_t>*, std::vector<std::string>*>;

/// Definition of a key (a row of the schema): its name, the variable (member) that it sets, the
/// accepted values and a description. The default is the value that the variable has when the
/// definition is made. A range of accepted values applies to each number of a list.
class Key {
 public:
  Key(std::string name, KeyMember member, std::string group, std::string help);

  // The following functions limit the accepted values. By default, any finite number or text is
  // accepted.
  Key& positive() { return between(0, infinity); }
  Key& not_negative() { return from(0, infinity); }
  /// Accepts numbers from low to high, both included.
  Key& from(double low, double high) { return with(range_, {low, high, false, false}); }
  /// Accepts numbers between low and high, both excluded.
  Key& between(double low, double high) { return with(range_, {low, high}); }
  /// Accepts positive numbers up to high, included.
  Key& positive_to(double high) { return with(range_, {0, high, true, false}); }
  /// Accepts angles in radians from -2 pi to 2 pi; 45, which is probably meant in degrees, is
  /// rejected.
  Key& angle() { return from(-2 * std::numbers::pi, 2 * std::numbers::pi).unit("rad"); }
  Key& one_of(std::vector<std::string> words) { return with(words_, std::move(words)); }
  /// Also accepts `old`, a former spelling of the accepted word `word`.
  Key& formerly(std::string old, std::string word) {
    return with(former_, {std::move(old), std::move(word)});
  }
  /// Sets a text that is appended to the error message for a word that is not accepted, for example
  /// what replaces a word of earlier versions.
  Key& gone(std::string text) { return with(gone_, std::move(text)); }
  /// Requires a list of items with this many numbers each; `what` describes the numbers of an item,
  /// such as "x y z".
  Key& each_of(std::size_t numbers, std::string what) {
    return with(each_, numbers).with(shape_, std::move(what));
  }
  /// Requires a list of exactly this many numbers; `what` describes them, such as "first last".
  Key& exactly(std::size_t numbers, std::string what) {
    return with(exactly_, numbers).with(shape_, std::move(what));
  }
  // The following functions set further properties of the key.
  Key& unit(std::string text) { return with(unit_, std::move(text)); }
  /// Sets the units of the numbers of an item of each_of() or exactly(), in their order and
  /// separated by blanks, if they differ; 1 is the unit of a plain number: "length length length
  /// 1".
  Key& units(const std::string& of_item);
  /// States in which cases the key applies, if not in all: "soft, hard, tm and te".
  Key& only_of(std::string what) { return with(only_of_, std::move(what)); }
  /// Marks a key that sets run time or computing resources, such as threads. It is not part of the
  /// identity of a result.
  Key& effort() { return with(effort_, true); }
  /// The key is accepted only on the command line, not in scene files.
  Key& no_file() { return with(in_files_, false); }
  Key& swept() { return with(swept_, true); }  ///< a sweep may vary the key
  /// Marks a key whose value is the path of an input file, so that the content of the file is part
  /// of the identity of the run.
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
  bool is_whole() const;  ///< whether the values are whole numbers
  bool is_number() const;
  const void* address() const;

  /// Returns the description for --help, with accepted words, unit and the cases in which the key
  /// applies.
  std::string help() const;
  /// Returns the requirement, e.g. "must be positive".
  std::string accepted() const;

  /// Returns the value as texts, empty if not set. Numbers have the shortest form that reads back
  /// as the same number.
  std::vector<std::string> value() const;
  const std::vector<std::string>& default_value() const { return default_; }
  /// Whether the value differs from the default. Keys that are set to their default count as not
  /// given, because a resolved scene (--print-config) contains them too.
  bool given() const { return value() != default_; }
  /// Returns the value as one text for messages, such as "1 2 3".
  std::string shown() const;
  /// Returns the line "key = value" of a scene file.
  std::string line() const;

  /// Returns the unit of the numbers of the key, for written_number(). metres: the scene's unit of
  /// length in metres, if known. position: that of the number in a list.
  KeyUnit number_unit(const std::optional<double>& metres = {}, std::size_t position = 0) const;

  /// Parses the texts and sets the variable. metres: as above. set() and check() throw InputError
  /// for values that are not accepted; the message names the key, the value and the accepted
  /// values.
  void set(const std::vector<std::string>& texts, const std::optional<double>& metres = {}) const;
  void check() const;

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  struct Range {
    double low = -infinity, high = infinity;
    bool low_open = true, high_open = true;

    bool has(double value) const;
    /// Returns the requirement, e.g. "must be positive". whole: for whole numbers.
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
  /// Former spelling of an accepted word, and the word that replaces it.
  std::pair<std::string, std::string> former_;
  KeyMember member_;
  std::vector<std::string> default_, words_, units_;
  Range range_;
  bool effort_ = false, in_files_ = true, swept_ = false, file_ = false;
  std::size_t each_ = 0, exactly_ = 0;
};

}  // namespace flatspeckle
