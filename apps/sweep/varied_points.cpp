#include "apps/sweep/varied_points.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "apps/command/key_lists.h"
#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"
#include "core/keys/written_number.h"

namespace flatspeckle::apps {

namespace {

constexpr std::size_t most_points = 1'000'000;

[[noreturn]] void refuse(const std::string& text, const std::string& accepted) {
  throw InputError("vary", text, accepted);
}

/// One text for one number: points are known by their texts.
AxisValues values_of(const Key& key, const std::string& values) {
  std::vector<std::string> texts;
  if (key.is_number()) {
    const std::string name = "vary " + key.name();
    const Written kind = written_kind(key.unit());
    if (const auto range = written_range(name, values, kind)) return AxisValues(*range);
    for (const double value : written_numbers(name, values, kind))
      texts.push_back(number_text(value));
    return texts;
  }
  std::istringstream words(values);
  for (std::string word; std::getline(words, word, ',');) texts.push_back(word);
  if (texts.empty()) refuse(key.name() + "=", "must have a value or more");
  return texts;
}

/// In a range only neighbours can be.
void refuse_twins(const SweepAxis& axis) {
  const NumberRange* const range = axis.values.range();
  std::set<std::string> seen;
  for (std::size_t i = 0; i < axis.values.size(); ++i) {
    const bool is_new = range == nullptr ? seen.insert(axis.values[i]).second
                                         : i == 0 || range->at(i) != range->at(i - 1);
    if (!is_new) refuse(axis.key, "has the value " + axis.values[i] + " twice");
  }
}

SweepPoints grid_of(const VaryValues& values, const Keys& of) {
  SweepPoints points;
  for (const std::string& text : values.vary) {
    points.axes.push_back(varied_axis(of, text));
    const SweepAxis& axis = points.axes.back();
    for (std::size_t i = 0; i + 1 < points.axes.size(); ++i)
      if (points.axes[i].key == axis.key) refuse(text, axis.key + " is varied already");
  }
  require_at_most(most_points, points);
  return points;
}

SweepPoints list_of(const std::string& path, const Keys& of) {
  const Table table = read_csv(path);
  if (table.rows() == 0) throw InputError("points", path, "must have at least one row");
  SweepPoints points;
  points.is_list = true;
  for (const std::string& name : table.names()) {
    if (!varied_key(of, name, name).is_number()) refuse(name, "has no numbers, as a table has");
    std::vector<std::string> values;
    for (const double value : table.column(name)) values.push_back(number_text(value));
    points.axes.push_back({name, std::move(values)});
  }
  require_at_most(most_points, points);
  refuse_twins(points);
  return points;
}

/// What follows the key's name: a number from 0 on, "all", or nothing.
std::string component_of(const SweepAxis& axis) {
  const auto dot = axis.key.find('.');
  return dot == std::string::npos ? "" : axis.key.substr(dot + 1);
}

/// All the numbers of a key, of which the axis sets one or all.
std::vector<std::string> with_component(const Keys& keys, const SweepAxis& axis,
                                        const std::string& value) {
  std::vector<std::string> texts = keys.find(key_of(axis))->value();
  const std::string component = component_of(axis);
  if (component.empty()) {
    if (texts.size() > 1)
      refuse(axis.key, "has " + std::to_string(texts.size()) + " values: vary " + axis.key +
                           ".0, the first, another, or " + axis.key + ".all");
    return {value};
  }
  if (component == "all") return std::vector(texts.size(), value);
  const auto number = read_whole_number(component);
  if (!number || *number < 0 || static_cast<std::size_t>(*number) >= texts.size())
    refuse(axis.key, "must be .all or a number below the " + std::to_string(texts.size()) +
                         " values that the key is given");
  texts[static_cast<std::size_t>(*number)] = value;
  return texts;
}

}  // namespace

const Key& varied_key(const Keys& of, const std::string& name, const std::string& text) {
  const Key* const key = of.find(key_of({name, {}}));
  if (key == nullptr) refuse(text, name + " is no key of that subcommand" + did_you_mean(of, name));
  if (key->is_effort() || !key->is_in_files())
    refuse(text, name + " says how to run, not what, and cannot be swept");
  if (key->is_file()) refuse(text, name + " names a file, and cannot be swept");
  return *key;
}

SweepAxis varied_axis(const Keys& of, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    refuse(text, "must be key=values: 1,2,3 or first:last:count or first:last:count:log");
  const std::string name = text.substr(0, equals);
  SweepAxis axis{name, values_of(varied_key(of, name, text), text.substr(equals + 1))};
  refuse_twins(axis);
  return axis;
}

void add_vary_key(Keys& keys, VaryValues& values) {
  keys.add("vary", values.vary,
           "What to sweep, all combinations: key=1,2,3 or key=first:last:count or "
           "key=first:last:count:log; key.0 is the first value of a key of several, key.all all")
      .only_of("sweeps of another subcommand, and of plan in fit");
}

void add_keys(Keys& keys, VaryValues& values) {
  add_vary_key(keys, values);
  keys.add("points", values.points, "CSV with columns named by keys: a list of points instead");
}

SweepPoints varied_points(const Keys& keys, const VaryValues& values, const Keys& of) {
  const bool is_list = !keys.read(values.points).empty(), is_grid = !keys.read(values.vary).empty();
  if (is_list == is_grid)
    throw InputError(is_list ? "vary, points: give one"
                             : "vary is not given: key=values to sweep, or points, a table");
  return is_list ? list_of(values.points, of) : grid_of(values, of);
}

void set_point(const SweepPoints& points, std::size_t point, const Keys& keys) {
  for (std::size_t i = 0; i < points.axes.size(); ++i) {
    const SweepAxis& axis = points.axes[i];
    keys.set(key_of(axis), with_component(keys, axis, points.value(i, point)));
  }
}

std::string key_of(const SweepAxis& axis) {
  return axis.key.substr(0, axis.key.find('.'));
}

std::string axis_name(const SweepAxis& axis) {
  std::string name = axis.key;
  std::ranges::replace(name, '.', '_');
  return name;
}

}  // namespace flatspeckle::apps
