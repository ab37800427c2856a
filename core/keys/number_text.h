#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Largest accepted magnitude of numbers in keys and tables. Products of a few such numbers do not
/// overflow.
constexpr double most_input = 1e50;

// The functions below convert numbers and lists to text and back, independent of the locale.

/// Returns the shortest text that is parsed as exactly the same number; "20" for 20.0.
std::string number_text(double value);
std::string number_text(Complex value);
/// Returns the numbers as one text for messages, such as "1 2 3".
std::string number_text(const std::vector<double>& values);
std::string join_texts(const std::vector<std::string>& texts, const std::string& between);

/// Returns the text without leading and trailing blanks.
std::string_view trimmed(std::string_view text);

/// Parses a text that is a number, including inf and nan. Returns nullopt for any other text.
std::optional<double> read_number(const std::string& text);
/// Parses a text that is an integer of up to 18 digits; "1e6" is also accepted. Returns nullopt for
/// any other text.
std::optional<std::int64_t> read_whole_number(const std::string& text);

}  // namespace flatspeckle
