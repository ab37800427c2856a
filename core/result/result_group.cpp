#include "core/result/result_group.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "core/result/hdf5_handle.h"

namespace flatspeckle {

namespace {

/// Names, as in type_name(), of the types that Values can contain, in the order of the variant.
constexpr const char* value_types[] = {"float64", "complex", "uint64", "texts"};
/// Names, as in AttributeRow::type, of the types that Attribute can contain, in the order of the
/// variant.
constexpr const char* attribute_types[] = {"bool", "int64",    "uint64", "float64",
                                           "text", "float64s", "texts"};

bool is_finite(const Values& values) {
  return std::visit(
      []<typename Value>(std::span<const Value> given) {
        if constexpr (std::is_same_v<Value, std::string>)
          return true;
        else
          return all_finite(given);
      },
      values);
}

bool is_finite(const Attribute& value) {
  if (const auto* number = std::get_if<double>(&value)) return std::isfinite(*number);
  const auto* numbers = std::get_if<std::vector<double>>(&value);
  return numbers == nullptr || all_finite(std::span<const double>(*numbers));
}

bool is_role(const std::string& word) {
  const auto is_capital = [](unsigned char letter) { return std::isupper(letter) != 0; };
  return word.size() > 1 && is_capital(word[0]) && is_capital(word[1]);  // "Hz" is a unit
}

}  // namespace

std::string type_name(Data data) {
  static constexpr const char* names[] = {"float64", "float64", "float64", "complex", "uint64",
                                          "texts",   "float64", "complex", "float64"};
  return names[static_cast<std::size_t>(data)];
}

bool has_error(Data data) {
  return data == Data::estimate || data == Data::complex_estimate;
}

bool has_row(const DatasetTable& table, const std::string& path) {
  return std::ranges::any_of(table.rows, [&](const DatasetRow& row) { return row.path == path; });
}

const DatasetRow& row_of(const DatasetTable& table, const std::string& path) {
  const auto found = std::find_if(table.rows.begin(), table.rows.end(),
                                  [&](const DatasetRow& row) { return row.path == path; });
  if (found == table.rows.end()) throw std::logic_error(path + ": no row for it in " + table.name);
  return *found;
}

ResultGroup::ResultGroup(ResultFile& file, const DatasetTable& table, const std::string& group)
    : file_(file), table_(table), prefix_(group.empty() ? "" : group + '/') {}

void ResultGroup::put(const std::string& path, const Values& values) const {
  if (has_error(row(path).data) || row(path).data == Data::invariant)
    throw std::logic_error(path + ": its standard errors or limits are not given");
  write(row(path), values);
}

void ResultGroup::put(const std::string& path, const Values& values, std::span<const double> errors,
                      std::span<const std::uint64_t> rare) const {
  const DatasetRow& found = row(path);
  if (!has_error(found.data)) throw std::logic_error(path + ": its row has no standard errors");
  write(found, values);
  write({path + "_error", Data::real, found.axes, found.unit, "standard error: " + found.long_name},
        errors);
  const auto few = std::count(rare.begin(), rare.end(), std::uint64_t{1});
  if (few == 0) return;
  write({path + "_rare", Data::count, found.axes, "1",
         "1 where a few batches dominate the standard error: " + found.long_name},
        rare);
  const bool is_nothing =
      std::all_of(errors.begin(), errors.end(), [](double e) { return e == 0; });
  if (is_nothing) return;  // all values are 0, because no path has contributed
  file_.note_rare(prefix_ + path + ": " + std::to_string(few) + " of " +
                  std::to_string(rare.size()));
}

void ResultGroup::put(const std::string& path, const Estimate& estimate) const {
  if (row(path).data == Data::complex_estimate)
    put(path, estimate.value, estimate.error, estimate.rare);
  else
    put(path, real_parts(estimate.value), estimate.error, estimate.rare);
}

void ResultGroup::check(const std::string& path, std::span<const Invariant> invariants) const {
  const DatasetRow& found = row(path);
  if (found.data != Data::invariant) throw std::logic_error(path + ": its row is not an invariant");
  std::vector<double> off, limits;
  const Invariant* worst = &invariants.front();
  for (const Invariant& each : invariants) {
    off.push_back(each.off);
    limits.push_back(each.limit);
    if (each.is_worse_than(*worst)) worst = &each;
  }
  write(found, std::span<const double>(off));
  write(
      {path + "_limit", Data::real, found.axes, found.unit, "largest allowed: " + found.long_name},
      std::span<const double>(limits));
  file_.note_invariant(prefix_ + path, *worst);
}

void ResultGroup::number(const std::string& path, std::size_t count) const {
  if (row(path).data != Data::numbers)
    throw std::logic_error(path + ": its row is not a numbering");
  file_.scale(
      prefix_ + path, count, [](std::size_t i) { return static_cast<double>(i); }, unit(row(path)),
      row(path).long_name);
}

void ResultGroup::begin(const std::string& path, const std::vector<std::size_t>& chunk) const {
  const DatasetRow& found = row(path);
  file_.begin_dataset(prefix_ + path, std::span<const Complex>(), axes(found), chunk, unit(found),
                      found.long_name);
}

void ResultGroup::attribute(const std::string& object, const std::string& name,
                            const Attribute& value) const {
  const auto& all = table_.attributes;
  const auto found = std::find_if(all.begin(), all.end(), [&](const AttributeRow& row) {
    return row.object == object && row.name == name && row.type == attribute_types[value.index()];
  });
  if (found == all.end())
    throw std::logic_error(object + ": no row for its attribute " + name + " in " + table_.name);
  const std::string path = prefix_ + object;
  if (!object.empty() && std::ranges::count(file_.undefined(), path) > 0) return;
  if (!is_finite(value)) return file_.note_undefined(path + '@' + name);
  file_.attribute(path.empty() ? "/" : path, name, value);
}

void ResultGroup::write(const DatasetRow& row, const Values& values) const {
  const std::string name = prefix_ + row.path;
  if (value_types[values.index()] != type_name(row.data))
    throw std::logic_error(name + ": its row requires " + type_name(row.data));
  if (row.data == Data::scale || row.data == Data::numbers)
    file_.scale(name, std::get<0>(values), unit(row), row.long_name);
  else if (!is_finite(values))
    file_.note_undefined(name);
  else
    file_.dataset(name, values, axes(row), unit(row), row.long_name);
}

std::vector<Axis> ResultGroup::axes(const DatasetRow& row) const {
  std::vector<Axis> axes;
  std::istringstream words(row.axes);
  for (std::string word; words >> word;) {
    if (is_role(word)) {
      const auto& bound = file_.bound(word);
      axes.insert(axes.end(), bound.begin(), bound.end());
    } else {
      axes.emplace_back(file_.has(prefix_ + word) ? prefix_ + word : word);
    }
  }
  return axes;
}

std::string ResultGroup::unit(const DatasetRow& row) const {
  return is_role(row.unit) ? std::get<std::string>(file_.bound(row.unit).at(0)) : row.unit;
}

}  // namespace flatspeckle
