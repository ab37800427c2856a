#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/numbers/complex.h"

namespace flatspeckle {

/// Of numbers in keys and tables: products of a few, and of inverses of positive ones, stay numbers.
constexpr double most_input = 1e50;

// Numbers and lists as texts, in any locale.

/// The shortest that reads back as the same number: 20.0 and 2e1 are "20".
std::string number_text(double value);
std::string number_text(Complex value);
/// "1 2 3", for messages.
std::string number_text(const std::vector<double>& values);
std::string joined(const std::vector<std::string>& texts, const std::string& between);

/// Without the blanks around it.
std::string_view trimmed(std::string_view text);

/// The number that the whole text is, if it is one; inf and nan are.
std::optional<double> read_number(const std::string& text);
/// The same of up to 18 digits; "1e6" is a whole number too.
std::optional<std::int64_t> read_whole_number(const std::string& text);
/// "1.5", "1.5+0.1i", "0.1 + 5i". Throws InputError.
Complex parse_complex(const std::string& key, const std::string& text);

}  // namespace flatspeckle
