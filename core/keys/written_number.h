#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace flatspeckle {

// Parsing of the numbers that users write for keys.

/// Kind of a number that a user writes. An angle may have a unit (deg, mrad, rad), a plain number
/// must not.
enum class Written { number, angle };

/// Returns the kind of the numbers of a key whose unit is `unit`: angle for "rad".
Written written_kind(const std::string& unit);

/// Parses numbers such as "0.1", "pi", "-0.25pi", "pi/2" and "pi - 0.2", and angles such as
/// "30deg", "5mrad" and "0.1rad". Returns nullopt for any other text.
std::optional<double> written_number(const std::string& text, Written kind);

/// Returns the error message for a text that is not a number of this kind.
const char* must_be_number(Written kind);

/// Numbers from first to last, both included, with equal differences or (logarithmic) equal ratios.
struct NumberRange {
  double first = 0, last = 0;
  std::size_t count = 0;
  bool in_ratios = false;

  double at(std::size_t number) const;
  /// Returns the index of a number of the range that equals `value`; nullopt if there is none.
  std::optional<std::size_t> find(double value) const;
};

/// Parses a range written as "first:last:count" or "first:last:count:log". Returns nullopt for a
/// text without a colon or with a comma, which is no range. Throws InputError for an invalid range;
/// the message names the key.
std::optional<NumberRange> written_range(const std::string& key, const std::string& text,
                                         Written kind);

/// Parses a list of numbers and ranges, such as "0.1", "0, 0.1, pi" or "0:1:11, 2". Throws
/// InputError; the message names the key.
std::vector<double> written_numbers(const std::string& key, const std::string& text, Written kind);

}  // namespace flatspeckle
