#pragma once

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

/// One or several of them: "0.1", "0, 0.1, pi", and ranges with both ends, "first:last:count" in
/// equal steps or "first:last:count:log" in equal ratios. Throws InputError naming the key.
std::vector<double> written_numbers(const std::string& key, const std::string& text, Written kind);

}  // namespace flatspeckle
