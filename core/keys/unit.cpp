#include "core/keys/unit.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "core/keys/number_text.h"

namespace flatspeckle {

namespace {

/// Text for the scene's unit of length in the units of keys.
constexpr std::string_view scene_length = "length";

struct NamedUnit {
  std::string_view name;
  Unit unit;
};

constexpr Dimension of_length{.length = 1}, of_time{.time = 1}, of_frequency{.time = -1},
    of_angle{.angle = 1}, of_mass{.mass = 1}, of_temperature{.temperature = 1},
    of_pressure{.length = -1, .time = -2, .mass = 1}, of_power{.length = 2, .time = -3, .mass = 1};

constexpr std::array<NamedUnit, 31> named_units = {{
    {"nm", {of_length, 1e-9}},
    {"um", {of_length, 1e-6}},
    {"mm", {of_length, 1e-3}},
    {"cm", {of_length, 1e-2}},
    {"m", {of_length, 1}},
    {"km", {of_length, 1e3}},
    {"fs", {of_time, 1e-15}},
    {"ps", {of_time, 1e-12}},
    {"ns", {of_time, 1e-9}},
    {"us", {of_time, 1e-6}},
    {"ms", {of_time, 1e-3}},
    {"s", {of_time, 1}},
    {"Hz", {of_frequency, 1}},
    {"kHz", {of_frequency, 1e3}},
    {"MHz", {of_frequency, 1e6}},
    {"GHz", {of_frequency, 1e9}},
    {"THz", {of_frequency, 1e12}},
    {"urad", {of_angle, 1e-6}},
    {"mrad", {of_angle, 1e-3}},
    {"rad", {of_angle, 1}},
    {"deg", {of_angle, std::numbers::pi / 180}},
    {"K", {of_temperature, 1}},
    {"mPa", {of_pressure, 1e-3}},
    {"Pa", {of_pressure, 1}},
    {"kPa", {of_pressure, 1e3}},
    {"MPa", {of_pressure, 1e6}},
    {"mW", {of_power, 1e-3}},
    {"W", {of_power, 1}},
    {"mg", {of_mass, 1e-6}},
    {"g", {of_mass, 1e-3}},
    {"kg", {of_mass, 1}},
}};

/// Multiplies a unit by a power of another one.
void multiply_by(Unit& unit, const Unit& by, int power) {
  constexpr std::array bases{&Dimension::length, &Dimension::time, &Dimension::mass,
                             &Dimension::temperature, &Dimension::angle};
  for (const auto base : bases) unit.dimension.*base += power * by.dimension.*base;
  unit.size *= std::pow(by.size, power);
}

/// Removes and returns the letters at the start of a text.
std::string_view take_letters(std::string_view& text) {
  const auto end = std::ranges::find_if_not(text, [](unsigned char c) { return std::isalpha(c); });
  const auto letters = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(letters.size());
  return letters;
}

/// Removes the exponent at the start of a text, "^2" or "^-1", and returns it; 1 if there is none,
/// nullopt if it is not a small whole number.
std::optional<int> take_exponent(std::string_view& text) {
  if (!text.starts_with('^')) return 1;
  int exponent = 0;
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), exponent);
  constexpr int most = 9;
  if (error != std::errc() || exponent == 0 || std::abs(exponent) > most) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return exponent;
}

double to_15_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", value);
  return std::strtod(text, nullptr);
}

/// Returns the unit of a key with another name for the scene's unit of length.
std::string with_length(std::string_view unit, std::string_view name) {
  std::string text(unit);
  if (const auto at = text.find(scene_length); at != text.npos)
    text.replace(at, scene_length.size(), name);
  return text;
}

}  // namespace

std::optional<Unit> unit_of(std::string_view text) {
  Unit unit;
  text = trimmed(text);
  if (text.starts_with("1/")) text.remove_prefix(1);
  for (bool is_first = true; is_first || !text.empty(); is_first = false) {
    const std::size_t before = text.size();
    text = trimmed(text);
    const bool divides = text.starts_with('/');
    if (divides || (!is_first && text.starts_with('*'))) text = trimmed(text.substr(1));
    if (!is_first && text.size() == before) return std::nullopt;  // nothing separates two names
    const auto name = take_letters(text);
    const auto found =
        std::ranges::find_if(named_units, [&](const auto& row) { return row.name == name; });
    const auto exponent = take_exponent(text);
    if (found == named_units.end() || !exponent) return std::nullopt;
    multiply_by(unit, found->unit, divides ? -*exponent : *exponent);
  }
  return unit;
}

KeyUnit::KeyUnit(std::string text, const std::optional<double>& metres)
    : text_(std::move(text)), metres_(metres) {
  constexpr std::string_view between = " or ";
  for (std::string_view rest = text_; !rest.empty();) {
    const auto end = std::min(rest.find(between), rest.size());
    const auto part = rest.substr(0, end);
    rest.remove_prefix(std::min(end + between.size(), rest.size()));
    const bool is_of_scene = part.find(scene_length) != part.npos;
    if (const auto unit = unit_of(with_length(part, "m")))
      alternatives_.push_back({*unit, is_of_scene});
  }
}

const KeyUnit::Alternative* KeyUnit::find(const Unit& unit) const {
  const auto found = std::ranges::find_if(alternatives_, [&](const Alternative& alternative) {
    return alternative.unit.dimension == unit.dimension;
  });
  return found == alternatives_.end() ? nullptr : &*found;
}

bool KeyUnit::accepts(const Unit& unit) const {
  return find(unit) != nullptr;
}

bool KeyUnit::lacks_length(const Unit& unit) const {
  const Alternative* const own = find(unit);
  return own != nullptr && own->is_of_scene && !metres_;
}

double KeyUnit::convert(double number, const Unit& unit) const {
  const Alternative& own = *find(unit);
  const double size =
      own.unit.size * (own.is_of_scene ? std::pow(*metres_, unit.dimension.length) : 1);
  const bool is_angle = unit.dimension == of_angle;  // pi/180 has no end of digits to restore
  return is_angle ? number * (unit.size / size) : to_15_digits(number * (unit.size / size));
}

std::string KeyUnit::accepted() const {
  if (alternatives_.empty()) return "must be a number";
  if (text_ == "rad") return "must be a number such as 0.1, pi/2 or 30deg";
  if (text_ == "K") return "must be a temperature in kelvin, such as 295.15 (22 degrees Celsius)";
  const std::string example = with_length(text_.substr(0, text_.find(" or ")), "mm");
  return std::string("must be a number such as 0.1 or ") + (example.starts_with("1/") ? "" : "1 ") +
         example;
}

}  // namespace flatspeckle
