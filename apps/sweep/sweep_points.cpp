#include "apps/sweep/sweep_points.h"

#include <algorithm>
#include <set>
#include <span>
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

/// Returns the numbers as texts, by which points are identified; equal numbers have equal texts.
std::vector<std::string> texts_of(std::span<const double> values) {
  std::vector<std::string> texts;
  for (double value : values) texts.push_back(number_text(value));
  return texts;
}

AxisValues values_of(const Key& key, const std::string& values) {
  if (key.is_number()) {
    const std::string name = "vary " + key.name();
    const KeyUnit unit = key.number_unit();
    if (const auto range = written_range(name, values, unit)) return AxisValues(*range);
    return texts_of(written_numbers(name, values, unit));
  }
  std::vector<std::string> texts;
  std::istringstream words(values);
  for (std::string word; std::getline(words, word, ',');) texts.push_back(word);
  if (texts.empty()) refuse(key.name() + "=", "must have at least one value");
  return texts;
}

/// Throws InputError if there are more than `most` points.
void require_at_most(std::size_t most, const SweepPoints& points) {
  double count = 1;  // floating point, because the product may exceed the range of integers
  for (const SweepAxis& axis : points.axes)
    count = points.is_list ? static_cast<double>(axis.values.size())
                           : count * static_cast<double>(axis.values.size());
  if (count > static_cast<double>(most))
    throw InputError("points of the sweep", count, "must be at most " + std::to_string(most));
}

/// Throws InputError if two points are equal.
void refuse_twins(const SweepPoints& points) {
  std::set<std::string> seen;
  for (std::size_t point = 0; point < points.count(); ++point)
    if (!seen.insert(points.name(point)).second)
      throw InputError("the point " + points.name(point) + " is given twice");
}

/// Throws InputError if two values of an axis are equal. In a range, only successive values can be
/// equal.
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
      if (points.axes[i].key == axis.key)
        refuse(text, axis.key + " is varied twice; leave one out");
  }
  require_at_most(most_points, points);
  return points;
}

SweepPoints list_of(const std::string& own_key, const std::string& path, const Keys& of) {
  const Table table = read_key_table(own_key, path, [&](const std::string& name) {
    const Key* const key = of.find(key_of({name, {}}));
    return key != nullptr && key->unit() == "rad";
  });
  SweepPoints points;
  points.is_list = true;
  for (const std::string& name : table.names()) {
    if (of.find(key_of({name, {}})) == nullptr)
      throw InputError(
          own_key, path,
          "column " + name + ": not a key of that subcommand" + did_you_mean(of, name));
    if (!varied_key(of, name, name).is_number())
      refuse(name, "must be a key with numbers; vary other keys with --vary");
    points.axes.push_back({name, texts_of(table.column(name))});
  }
  require_at_most(most_points, points);
  refuse_twins(points);
  return points;
}

/// Returns the part of an axis's key after the dot: the number of a component (from 0), "all", or
/// empty if there is no dot.
std::string component_of(const SweepAxis& axis) {
  const auto dot = axis.key.find('.');
  return dot == std::string::npos ? "" : axis.key.substr(dot + 1);
}

/// Returns the list of numbers of the key of an axis, with one or all of them set to `value`.
std::vector<std::string> with_component(const Keys& keys, const SweepAxis& axis,
                                        const std::string& value) {
  std::vector<std::string> texts = keys.find(key_of(axis))->value();
  const std::string component = component_of(axis);
  if (component.empty()) {
    if (texts.size() > 1)
      refuse(axis.key, "has " + std::to_string(texts.size()) +
                           " values: vary one, such as the first by " + axis.key +
                           ".0, or all by " + axis.key + ".all");
    return {value};
  }
  if (component == "all") return std::vector(texts.size(), value);
  const auto number = read_whole_number(component);
  if (!number || *number < 0 || static_cast<std::size_t>(*number) >= texts.size())
    refuse(axis.key, "must be .all or a number below " + std::to_string(texts.size()) +
                         ", the number of given values");
  texts[static_cast<std::size_t>(*number)] = value;
  return texts;
}

/// Returns the axes of the sweep: one for each key that has a list of values.
std::vector<SweepAxis> given_axes(const Keys& keys, const SweepLists& lists) {
  std::vector<SweepAxis> axes;
  for (const std::string& key : lists.keys) {
    std::vector<std::string> values;
    if (const auto numbers = lists.numbers.find(key); numbers != lists.numbers.end())
      values = texts_of(keys.read(numbers->second));
    else
      for (const std::string& text : keys.read(lists.texts.at(key)))
        values.push_back(number_text(parse_complex(key, text)));
    if (!values.empty()) axes.push_back({key, std::move(values)});
  }
  return axes;
}

/// Returns a column of the table as an axis, with one value per point.
SweepAxis column_axis(const Table& table, const std::string& key) {
  if (key != "index" || !table.has("index_imaginary")) return {key, texts_of(table.column(key))};
  const auto real = table.column("index"), imaginary = table.column("index_imaginary");
  std::vector<std::string> values;
  for (std::size_t row = 0; row < real.size(); ++row)
    values.push_back(number_text(Complex(real[row], imaginary[row])));
  return {key, std::move(values)};
}

void check_columns(const Table& table, const SweepLists& lists) {
  for (const std::string& name : table.names()) {
    if (name == "index_imaginary" && table.has("index")) continue;
    if (std::find(lists.keys.begin(), lists.keys.end(), name) == lists.keys.end())
      throw InputError(
          "points", lists.points,
          "column " + name + ": must be one of index_imaginary " + join_texts(lists.keys, " "));
  }
}

SweepPoints listed(const Keys& keys, const SweepLists& lists) {
  const Table table = read_key_table("points", lists.points);
  check_columns(table, lists);
  SweepPoints list;
  list.is_list = true;
  const auto given = given_axes(keys, lists);
  for (const std::string& key : lists.keys) {
    const auto beside = std::find_if(given.begin(), given.end(),
                                     [&](const SweepAxis& axis) { return axis.key == key; });
    if (beside == given.end() && !table.has(key)) continue;
    if (beside != given.end() && (table.has(key) || beside->values.size() > 1))
      throw InputError(key, beside->values.back(),
                       "must be one value, or a column of the table of points, not both");
    list.axes.push_back(
        beside == given.end()
            ? column_axis(table, key)
            : SweepAxis{key, std::vector<std::string>(table.rows(), beside->values.front())});
  }
  return list;
}

}  // namespace

const Key& varied_key(const Keys& of, const std::string& name, const std::string& text) {
  const Key* const key = of.find(key_of({name, {}}));
  if (key == nullptr)
    refuse(text, name + " is not a key of that subcommand" + did_you_mean(of, name));
  if (key->is_effort() || !key->is_in_files())
    refuse(text, name + " does not change the result and cannot be swept");
  if (key->is_file()) refuse(text, name + " names a file and cannot be swept");
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
           "Keys to sweep, in all combinations: key=1,2,3 or key=first:last:count or "
           "key=first:last:count:log; key.0 varies only the first value of a key with several "
           "values, key.all all of them")
      .only_of("sweeps of another subcommand, and of plan in fit");
}

void add_keys(Keys& keys, VaryValues& values) {
  add_vary_key(keys, values);
  // true if the swept subcommand has a key `points`
  const bool is_taken = keys.find("points") != nullptr;
  keys.add(is_taken ? "points_table" : "points", values.points,
           "CSV file with columns named by keys: each row is a point, instead of all combinations");
}

SweepPoints varied_points(const Keys& keys, const VaryValues& values, const Keys& of) {
  const bool is_list = !keys.read(values.points).empty(), is_grid = !keys.read(values.vary).empty();
  if (is_list == is_grid)
    throw InputError(is_list ? "vary, " + keys.name(values.points) + ": give only one of them"
                             : "vary is not given: give key=values, or " +
                                   keys.name(values.points) + ", a table of points");
  return is_list ? list_of(keys.name(values.points), values.points, of) : grid_of(values, of);
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

std::size_t AxisValues::size() const {
  return range() != nullptr ? range()->count : std::get<0>(values_).size();
}

std::string AxisValues::operator[](std::size_t number) const {
  return range() != nullptr ? number_text(range()->at(number)) : std::get<0>(values_)[number];
}

std::vector<std::string> AxisValues::texts() const {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < size(); ++i) texts.push_back((*this)[i]);
  return texts;
}

std::size_t SweepPoints::count() const {
  if (is_list) return axes.front().values.size();
  std::size_t count = 1;
  for (const SweepAxis& axis : axes) count *= axis.values.size();
  return count;
}

std::string SweepPoints::value(std::size_t axis, std::size_t point) const {
  if (!is_list)
    for (std::size_t faster = axes.size() - 1; faster > axis; --faster)
      point /= axes[faster].values.size();
  const AxisValues& values = axes[axis].values;
  return values[point % values.size()];
}

std::string SweepPoints::name(std::size_t point) const {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < axes.size(); ++i)
    parts.push_back(axes[i].key + '=' + value(i, point));
  return join_texts(parts, "_");
}

void add_sweep_keys(Keys& keys, SweepLists& lists) {
  keys.group("Swept keys: lists of values");
  const auto rows = keys.rows();
  for (const Key& row : rows) {
    const bool is_there = std::count(lists.keys.begin(), lists.keys.end(), row.name()) > 0;
    if (!row.is_swept() || is_there) continue;
    lists.keys.push_back(row.name());
    keys.remove(row.name());
    if (row.is_number())
      keys.add(row.name(), lists.numbers[row.name()], row.help());
    else
      keys.add(row.name(), lists.texts[row.name()], row.help());
  }
  keys.add("points", lists.points,
           "CSV file with columns among these keys (and index_imaginary): a list of points instead "
           "of all combinations");
}

SweepPoints sweep_points(const Keys& keys, const SweepLists& lists) {
  const bool is_list = !keys.read(lists.points).empty();
  SweepPoints points = is_list ? listed(keys, lists) : SweepPoints{given_axes(keys, lists)};
  require_at_most(100'000, points);
  refuse_twins(points);
  return points;
}

}  // namespace flatspeckle::apps
