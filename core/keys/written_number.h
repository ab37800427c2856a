#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace flatspeckle {

// Numbers of keys as people write them.

/// Whether degrees and milliradians may stand behind a number.
enum class Written { number, angle };

/// Of a key with this unit.
Written written_kind(const std::string& unit);

/// "0.1", "pi", "-0.25pi", "pi/2", "pi - 0.2"; of an angle also "30deg", "5mrad", "0.1rad". No
/// value if the text is anything else.
std::optional<double> written_number(const std::string& text, Written kind);

/// What is said of a text that is none.
const char* must_be_number(Written kind);

/// Numbers from the first to the last, both among them, in equal steps or in equal ratios.
struct NumberRange {
  double first = 0, last = 0;
  std::size_t count = 0;
  bool in_ratios = false;

  double at(std::size_t number) const;
  /// The number of this value.
  std::optional<std::size_t> find(double value) const;
};

/// "first:last:count" or "first:last:count:log"; nothing of a text without a colon or with a comma.
/// Throws InputError naming the key.
std::optional<NumberRange> written_range(const std::string& key, const std::string& text,
                                         Written kind);

/// One or several numbers and ranges of them: "0.1", "0, 0.1, pi", "0:1:11, 2". Throws InputError
/// naming the key.
std::vector<double> written_numbers(const std::string& key, const std::string& text, Written kind);

}  // namespace flatspeckle
