#include "flatland/scene/optical_frequency.h"

#include <algorithm>
#include <functional>
#include <sstream>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"
#include "core/numbers/constants.h"

namespace flatspeckle {

std::optional<double> optical_frequency(const SceneSpec& spec,
                                        const std::optional<double>& metres) {
  if (!spec.medium_index || !metres) return std::nullopt;
  return light_speed / (spec.wavelength * *metres);
}

namespace {

/// Whether a part of a list, "first:last:count" or a number, contains a plain number other than 0.
bool has_plain_number(const std::string& part) {
  std::istringstream numbers(part);
  std::string number;
  for (int i = 0; i < 2 && std::getline(numbers, number, ':'); ++i)
    if (written_number(number, KeyUnit()).value_or(0) != 0) return true;
  return false;
}

bool has_plain_numbers(const std::string& text) {
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');)
    if (has_plain_number(part)) return true;
  return false;
}

std::optional<std::vector<double>> numbers_in(const std::string& key, const std::string& text,
                                              const std::string& unit) try {
  return written_numbers(key, text, KeyUnit(unit));
} catch (const InputError&) {
  return std::nullopt;
}

/// Returns the relative frequency that a number in a unit is, and the unit.
using Conversion = std::pair<const char*, std::function<double(double)>>;
std::vector<Conversion> conversions(double optical, FrequencyKind kind) {
  const double wavelength = light_speed / optical;
  const auto by_wavelength = [=](double change) {
    return kind == FrequencyKind::shift ? -change / (wavelength + change) : change / wavelength;
  };
  return {{"Hz", [=](double change) { return change / optical; }},
          {"m", by_wavelength},
          {"1/m", [=](double change) { return change * wavelength; }}};
}

}  // namespace

std::vector<double> relative_frequencies(const std::string& key,
                                         const std::vector<std::string>& texts,
                                         const std::optional<double>& optical, FrequencyKind kind) {
  constexpr const char* accepted =
      "must be a relative number such as 1e-5, or a frequency, a wavelength or a wavenumber such "
      "as 1GHz, 0.1nm or 0.5/cm";
  std::vector<double> all;
  const auto relative = [&](const std::string& text) {
    if (const auto plain = numbers_in(key, text, "")) return *plain;
    for (const auto& [unit, convert] : conversions(optical.value_or(1), kind)) {
      auto numbers = numbers_in(key, text, unit);
      if (!numbers) continue;
      if (!optical)
        throw InputError(key, text,
                         "has a unit: also give medium_index, so that the wavelength is that in "
                         "vacuum, and length_unit");
      if (has_plain_numbers(text))
        throw InputError(key, text, "must give a unit to each number except 0, or to none");
      std::ranges::transform(*numbers, numbers->begin(), convert);
      return *numbers;
    }
    throw InputError(key, text, accepted);
  };
  for (const std::string& text : texts)
    for (const double number : relative(text)) all.push_back(number);
  return all;
}

}  // namespace flatspeckle
