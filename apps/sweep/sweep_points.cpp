#include "apps/sweep/sweep_points.h"

#include <algorithm>
#include <set>
#include <span>

#include "core/error.h"
#include "core/keys/csv.h"
#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

std::vector<std::string> texts_of(std::span<const double> values) {
  std::vector<std::string> texts;
  for (double value : values) texts.push_back(number_text(value));
  return texts;
}

/// Axes that were given. One text for one number: points are known by their texts.
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

/// A column of the table as an axis: one value for each point.
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
          "column " + name + ": must be one of index_imaginary " + joined(lists.keys, " "));
  }
}

SweepPoints listed(const Keys& keys, const SweepLists& lists) {
  const Table table = read_csv(lists.points);
  check_columns(table, lists);
  if (table.rows() == 0) throw InputError("points", lists.points, "must have at least one row");
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
  return joined(parts, "_");
}

void add_sweep_keys(Keys& keys, SweepLists& lists) {
  keys.group("Swept: lists of values");
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
           "CSV with columns among these keys (and index_imaginary): a list of points in place of "
           "all combinations");
}

void require_at_most(std::size_t most, const SweepPoints& points) {
  double count = 1;  // which may be beyond what a whole number holds
  for (const SweepAxis& axis : points.axes)
    count = points.is_list ? static_cast<double>(axis.values.size())
                           : count * static_cast<double>(axis.values.size());
  if (count > static_cast<double>(most))
    throw InputError("points of the sweep", count, "must be at most " + std::to_string(most));
}

void refuse_twins(const SweepPoints& points) {
  std::set<std::string> seen;
  for (std::size_t point = 0; point < points.count(); ++point)
    if (!seen.insert(points.name(point)).second)
      throw InputError("the point " + points.name(point) + " is given twice");
}

SweepPoints sweep_points(const Keys& keys, const SweepLists& lists) {
  const bool is_list = !keys.read(lists.points).empty();
  SweepPoints points = is_list ? listed(keys, lists) : SweepPoints{given_axes(keys, lists)};
  require_at_most(100'000, points);
  refuse_twins(points);
  return points;
}

}  // namespace flatspeckle::apps
