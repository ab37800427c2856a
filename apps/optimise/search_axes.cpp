#include "apps/optimise/search_axes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "apps/sweep/sweep_points.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"

namespace flatspeckle::apps {

namespace {

constexpr const char* forms =
    "must be key=low:high with low < high, key=low:high:log with bounds above 0, or values to "
    "choose from: key=1,2,3";

[[noreturn]] void refuse(const std::string& text) {
  throw InputError("vary", text, forms);
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char letter : text)
    if (letter == ':')
      parts.emplace_back();
    else
      parts.back() += letter;
  return parts;
}

/// low:high and low:high:log; with three numbers it is a list of values.
bool is_between(const std::vector<std::string>& parts) {
  return parts.size() == 2 || (parts.size() == 3 && trimmed(parts[2]) == "log");
}

SearchAxis between(const Keys& of, const std::string& text, const std::string& name,
                   const std::vector<std::string>& parts) {
  const Key& key = varied_key(of, name, text);
  if (!key.is_number()) refuse(text);
  const auto low = written_number(parts[0], written_kind(key.unit()));
  const auto high = written_number(parts[1], written_kind(key.unit()));
  const bool is_log = parts.size() == 3;
  if (!low || !high || !(*low < *high) || (is_log && *low <= 0) || !std::isfinite(*high - *low))
    refuse(text);
  if (!key.is_whole()) return {name, *low, *high, is_log};
  constexpr double most = 64;
  if (*high - *low > most || is_log)
    throw InputError("vary", text, "of whole numbers at most 64 are searched, one by one");
  SearchAxis choice{name};
  for (double value = std::ceil(*low); value <= *high; ++value)
    choice.values.push_back(number_text(value));
  return choice;
}

SearchAxis axis_of(const Keys& of, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse(text);
  const std::string name = text.substr(0, equals);
  const auto parts = parts_of(text.substr(equals + 1));
  if (is_between(parts)) return between(of, text, name, parts);
  SearchAxis choice{name};
  choice.values = varied_axis(of, text).values.texts();
  return choice;
}

double value_at(const SearchAxis& axis, double share) {
  const double value = axis.is_log ? axis.low * std::pow(axis.high / axis.low, share)
                                   : axis.low + share * (axis.high - axis.low);
  return std::clamp(value, axis.low, axis.high);
}

}  // namespace

bool SearchAxis::is_turn() const {
  constexpr double turn = 2 * std::numbers::pi, as_written = 1e-4 * turn;
  const bool is_centred = std::abs(low + high) < as_written;
  return !is_log && (low == 0 || is_centred) && std::abs(high - low - turn) < as_written;
}

SearchAxes::SearchAxes(const std::vector<std::string>& vary, const Keys& of) {
  std::set<std::string> seen;
  for (const std::string& text : vary) {
    axes_.push_back(axis_of(of, text));
    if (!seen.insert(axes_.back().key).second)
      throw InputError("vary", text, axes_.back().key + " is varied already");
    if (axes_.back().key == "seed")
      throw InputError("vary", text, "random numbers are not searched; sweep tries several seeds");
  }
  if (dimensions() == 0)
    throw InputError("vary: give a key between bounds, key=low:high; sweep tries lists of values");
}

std::size_t SearchAxes::dimensions() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(axes_, [](const SearchAxis& axis) { return !axis.is_choice(); }));
}

std::size_t SearchAxes::choices() const {
  std::size_t choices = 1;
  for (const SearchAxis& axis : axes_)
    if (axis.is_choice()) choices *= axis.values.size();
  return choices;
}

SweepPoints SearchAxes::point(const SearchPlace& place) const {
  SweepPoints point{{}, true};
  auto share = place.at.begin();
  std::size_t choice = place.choice;
  for (const SearchAxis& axis : axes_) {
    if (!axis.is_choice()) {
      point.axes.push_back({axis.key, {number_text(value_at(axis, *share++))}});
      continue;
    }
    point.axes.push_back({axis.key, {axis.values[choice % axis.values.size()]}});
    choice /= axis.values.size();
  }
  return point;
}

std::vector<std::string> SearchAxes::at_bounds(const SearchPlace& place, double tolerance) const {
  std::vector<std::string> keys;
  auto share = place.at.begin();
  for (const SearchAxis& axis : axes_) {
    if (axis.is_choice()) continue;
    if (!axis.is_turn() && std::min(*share, 1 - *share) <= tolerance) keys.push_back(axis.key);
    ++share;
  }
  return keys;
}

}  // namespace flatspeckle::apps
