#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/keys/unit.h"
#include "core/numbers/complex.h"

namespace flatspeckle {

// Parsing of the numbers that users write for keys.

// A number is a sum of terms. A term is a number or a multiple of pi, then an optional unit of the
// dimension of the key's unit, then an optional divisor, which is a plain number: "2pi/3", "30deg",
// "633nm/1.33", "pi - 0.2". A term without a unit is in the unit of the key. "633/1.33nm" is
// refused, because the position of the unit is ambiguous. A unit may begin with a slash: "10/mm".

/// Parses a number. Returns nullopt for any other text, for a unit of another dimension than the
/// key's, and for lengths if the scene's unit of length is not known.
std::optional<double> written_number(const std::string& text, const KeyUnit& unit);

/// Returns the error message for a text that written_number() does not accept.
std::string must_be_number(const std::string& text, const KeyUnit& unit);

/// Returns a list of numbers and ranges with each number that has a unit replaced by a plain number
/// in the key's unit; other parts, also those that are no numbers, are unchanged.
std::string without_units(const std::string& text, const KeyUnit& unit);

/// Parses a complex number such as "1.5", "1.59/1.33", "1.5+0.1i" or "0.1 + 5i". Throws InputError
/// for any other text.
Complex parse_complex(const std::string& key, const std::string& text);

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
                                         const KeyUnit& unit);

/// Parses a list of numbers and ranges, such as "0.1", "0, 0.1, pi" or "0:1:11, 2". Throws
/// InputError; the message names the key.
std::vector<double> written_numbers(const std::string& key, const std::string& text,
                                    const KeyUnit& unit);
/// Parses a list whose numbers have different units, given by the position in the list.
std::vector<double> written_numbers(const std::string& key, const std::string& text,
                                    const std::function<KeyUnit(std::size_t)>& unit_of_number);

}  // namespace flatspeckle
