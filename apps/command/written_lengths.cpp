#include "apps/command/written_lengths.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <regex>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

const std::map<std::string, double> sizes = {{"nm", 1e-9}, {"um", 1e-6}, {"mm", 1e-3},
                                             {"cm", 1e-2}, {"m", 1},     {"km", 1e3}};

/// A number, perhaps a slash, a unit, perhaps ^2; no letter behind it.
const std::regex& length_form() {
  static const std::regex form(
      R"(((?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)\s*(/?)\s*(nm|um|mm|cm|km|m)(\^2)?(?![A-Za-z0-9^]))");
  return form;
}

/// Lengths, inverses and inverse squares: 1, -1, -2.
int power_of(const std::smatch& found) {
  const bool inverse = found.length(2) > 0, square = found.length(4) > 0;
  return (inverse ? -1 : 1) * (square ? 2 : 1);
}

/// Places and what stands with them in a row, "x y z power", may have either.
bool may_have(const Key& key, int power) {
  const std::string& unit = key.unit();
  const bool row =
      unit.empty() && key.is_list() && key.accepted().find("numbers") != std::string::npos;
  if (row) return power == 1 || power == -1;
  if (unit == "1/length or length") return power == 1 || power == -1;
  return (unit == "length" && power == 1) || (unit == "1/length" && power == -1) ||
         (unit == "1/length^2" && power == -2);
}

/// To 15 digits, which hide what the powers of ten have rounded.
std::string to_15_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", value);
  return text;
}

}  // namespace

std::optional<double> metres_of(const std::string& text) {
  if (const auto number = read_number(text)) return number;
  if (const auto size = sizes.find(text); size != sizes.end()) return size->second;
  std::smatch found;
  if (!std::regex_match(text, found, length_form()) || power_of(found) != 1) return std::nullopt;
  return *read_number(found[1]) * sizes.at(found[3]);
}

std::string in_unit_of_length(const Key& key, const std::string& text,
                              const std::optional<double>& metres) {
  std::string numbers, rest = text;
  for (std::smatch found; std::regex_search(rest, found, length_form()); rest = found.suffix()) {
    const int power = power_of(found);
    if (!may_have(key, power)) return text;
    if (!metres)
      throw InputError(key.name(), text,
                       "has a unit; say too what lengths without one are in: length_unit = um");
    const double size = std::pow(sizes.at(found[3]) / *metres, power);
    numbers += found.prefix().str() + to_15_digits(*read_number(found[1]) * size);
  }
  return numbers + rest;
}

}  // namespace flatspeckle::apps
