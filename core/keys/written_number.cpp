#include "core/keys/written_number.h"

#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/keys/number_text.h"

namespace flatspeckle {

namespace {

constexpr std::int64_t most_steps = 1'000'000;
constexpr const char* range_form =
    "must be first:last:count, or first:last:count:log with first and last of the same sign; "
    "0:1:11 has steps of 0.1";

std::optional<double> plain(std::string_view text) {
  return read_number(std::string(trimmed(text)));
}

/// Returns the unit at the end of a number, and the factor by which the unit converts the number;
/// an empty text and 1 if there is no unit. "mrad" is listed before "rad", with which it ends.
std::pair<std::string_view, double> unit_of(std::string_view text, Written kind) {
  constexpr double pi = std::numbers::pi;
  constexpr std::array<std::pair<std::string_view, double>, 4> units = {
      {{"pi", pi}, {"deg", pi / 180}, {"mrad", 1e-3}, {"rad", 1}}};
  for (const auto& unit : units)
    if (text.ends_with(unit.first) && (kind == Written::angle || unit.first == "pi")) return unit;
  return {"", 1};
}

/// Parses a number without sums, such as "2pi/3", "30deg" or "0.1".
std::optional<double> term(std::string_view text, Written kind) {
  text = trimmed(text);
  double divisor = 1;
  if (const auto slash = text.find('/'); slash != text.npos) {
    const auto below = plain(text.substr(slash + 1));
    if (!below || *below == 0) return std::nullopt;
    divisor = *below;
    text = trimmed(text.substr(0, slash));
  }
  const auto [unit, size] = unit_of(text, kind);
  text = trimmed(text.substr(0, text.size() - unit.size()));
  const auto factor = text.empty() && unit == "pi" ? 1 : plain(text);
  return factor ? std::optional(*factor * size / divisor) : std::nullopt;
}

/// Returns the position of the last + or - that adds or subtracts, as opposed to the sign of a
/// number or of an exponent. Returns npos if there is none.
std::size_t last_sign(std::string_view text) {
  for (std::size_t at = text.size(); at-- > 1;) {
    if (text[at] != '+' && text[at] != '-') continue;
    const std::string_view left = trimmed(text.substr(0, at));
    const char before = left.empty() ? '+' : left.back();
    if (before != '+' && before != '-' && before != '/' && std::tolower(before) != 'e') return at;
  }
  return text.npos;
}

std::vector<std::string> parts_of(const std::string& text, char between) {
  std::vector<std::string> parts(1);
  for (const char letter : text)
    if (letter == between)
      parts.emplace_back();
    else
      parts.back() += letter;
  return parts;
}

}  // namespace

Written written_kind(const std::string& unit) {
  return unit == "rad" ? Written::angle : Written::number;
}

std::optional<double> written_number(const std::string& text, Written kind) {
  std::string_view whole = trimmed(text);
  if (const auto number = read_number(std::string(whole))) return number;
  std::vector<double> added;  // terms of a sum, the last one first
  for (auto sign = last_sign(whole); sign != whole.npos; sign = last_sign(whole)) {
    const auto value = term(whole.substr(sign + 1), kind);
    if (!value) return std::nullopt;
    added.push_back(whole[sign] == '-' ? -*value : *value);
    whole = trimmed(whole.substr(0, sign));
  }
  const bool minus = whole.starts_with('-') && !whole.starts_with("--");
  const auto first = term(minus ? whole.substr(1) : whole, kind);
  if (!first) return std::nullopt;
  return std::accumulate(added.rbegin(), added.rend(), minus ? -*first : *first);
}

const char* must_be_number(Written kind) {
  return kind == Written::angle ? "must be a number such as 0.1, pi/2 or 30deg"
                                : "must be a number";
}

double NumberRange::at(std::size_t number) const {
  if (number + 1 == count) return last;
  const double step = (last - first) / static_cast<double>(count - 1);
  const bool is_whole =
      std::isfinite(step) && first == std::round(first) && step == std::round(step);
  if (!in_ratios && is_whole) return first + step * static_cast<double>(number);
  const double share = static_cast<double>(number) / static_cast<double>(count - 1);
  return in_ratios ? first * std::pow(last / first, share) : first * (1 - share) + last * share;
}

std::optional<std::size_t> NumberRange::find(double value) const {
  std::size_t low = 0, high = count;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    const bool is_before = first < last ? at(middle) < value : at(middle) > value;
    (is_before ? low : high) = is_before ? middle + 1 : middle;
  }
  return low < count && at(low) == value ? std::optional(low) : std::nullopt;
}

std::optional<NumberRange> written_range(const std::string& key, const std::string& text,
                                         Written kind) {
  if (text.find(':') == text.npos || text.find(',') != text.npos) return std::nullopt;
  const auto parts = parts_of(text, ':');
  const bool ratios = parts.size() == 4 && trimmed(parts[3]) == "log";
  const auto refuse = [&] { return InputError(key, text, range_form); };
  if (parts.size() != 3 && !ratios) throw refuse();
  const auto first = written_number(parts[0], kind), last = written_number(parts[1], kind);
  const auto count = read_whole_number(std::string(trimmed(parts[2])));
  if (!first || !last || !count || !std::isfinite(*first) || !std::isfinite(*last)) throw refuse();
  if (*count < 2 || *count > most_steps)
    throw InputError(key, text, "a range must have 2 to " + std::to_string(most_steps) + " values");
  if (ratios && !(*first * *last > 0)) throw refuse();
  return NumberRange{*first, *last, static_cast<std::size_t>(*count), ratios};
}

std::vector<double> written_numbers(const std::string& key, const std::string& text, Written kind) {
  std::vector<double> values;
  for (const std::string& part : parts_of(text, ',')) {
    if (const auto range = written_range(key, part, kind)) {
      for (std::size_t i = 0; i < range->count; ++i) values.push_back(range->at(i));
      continue;
    }
    const auto value = written_number(part, kind);
    if (!value) throw InputError(key, text, must_be_number(kind));
    values.push_back(*value);
  }
  return values;
}

}  // namespace flatspeckle
