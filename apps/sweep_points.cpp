#include "apps/sweep_points.h"

#include <algorithm>
#include <charconv>
#include <set>

#include "core/error.h"
#include "core/keys/csv.h"

namespace flatspeckle::apps {

namespace {

/// One text for one number: the points of a sweep are known by their texts.
std::string text_of(double value) {
  char digits[32];
  value += 0.0;  // -0 is 0
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

std::string text_of(Complex value) {
  if (value.imag() == 0) return text_of(value.real());
  return text_of(value.real()) + (value.imag() > 0 ? "+" : "") + text_of(value.imag()) + 'i';
}

std::vector<std::string> texts_of(std::span<const double> values) {
  std::vector<std::string> texts;
  for (double value : values) texts.push_back(text_of(value));
  return texts;
}

std::vector<std::string> texts_of_indices(const std::vector<std::string>& values) {
  std::vector<std::string> texts;
  for (const std::string& value : values) texts.push_back(text_of(parse_complex("index", value)));
  return texts;
}

double number_of(const std::string& text) {
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

void set(SceneSpec& spec, const std::string& key, const std::string& value) {
  if (key == "index") spec.index = value;
  if (key == "density") spec.density = number_of(value);
  if (key == "radius") spec.radius = number_of(value);
  if (key == "optical_depth") spec.optical_depth = number_of(value);
  if (key == "g") spec.g = number_of(value);
  if (key == "albedo") spec.albedo = number_of(value);
}

/// Axes that were given, in the order of sweep_keys().
std::vector<SweepAxis> given_axes(const SweepLists& lists) {
  std::vector<SweepAxis> axes{{"density", texts_of(lists.density)},
                              {"radius", texts_of(lists.radius)},
                              {"index", texts_of_indices(lists.index)},
                              {"optical_depth", texts_of(lists.optical_depth)},
                              {"g", texts_of(lists.g)},
                              {"albedo", texts_of(lists.albedo)}};
  std::erase_if(axes, [](const SweepAxis& axis) { return axis.values.empty(); });
  return axes;
}

std::vector<SweepPoint> product(const std::vector<SweepAxis>& axes) {
  constexpr double most_points = 1e5;
  double count = 1;
  for (const SweepAxis& axis : axes) count *= static_cast<double>(axis.values.size());
  if (count > most_points) throw InputError("points of the sweep", count, "must be at most 100000");
  std::vector<SweepPoint> points(1);
  for (const SweepAxis& axis : axes) {
    std::vector<SweepPoint> longer;
    for (const SweepPoint& point : points) {
      for (const std::string& value : axis.values) {
        longer.push_back(point);
        longer.back().values.push_back(value);
      }
    }
    points = std::move(longer);
  }
  return points;
}

/// A column of the table as an axis: one value for each point.
void add_column(const Table& table, const std::string& key, std::vector<SweepAxis>& axes) {
  SweepAxis axis{key, texts_of(table.column(key))};
  if (key == "index" && table.has("index_imaginary")) {
    const auto real = table.column("index"), imaginary = table.column("index_imaginary");
    for (std::size_t row = 0; row < real.size(); ++row)
      axis.values[row] = text_of(Complex(real[row], imaginary[row]));
  }
  axes.push_back(std::move(axis));
}

void check_columns(const Table& table, const std::string& path) {
  const auto& keys = sweep_keys();
  for (const std::string& name : table.names()) {
    if (name == "index_imaginary" && table.has("index")) continue;
    if (std::find(keys.begin(), keys.end(), name) == keys.end())
      throw InputError("points", path,
                       "column " + name +
                           ": must be one of density radius index index_imaginary optical_depth g "
                           "albedo");
  }
}

SweepPoints listed(const SweepLists& lists) {
  const Table table = read_csv(lists.points);
  check_columns(table, lists.points);
  if (table.rows() == 0) throw InputError("points", lists.points, "must have at least one row");
  SweepPoints list;
  list.is_list = true;
  list.points.resize(table.rows());
  const auto given = given_axes(lists);
  for (const std::string& key : sweep_keys()) {
    const auto beside = std::find_if(given.begin(), given.end(),
                                     [&](const SweepAxis& axis) { return axis.key == key; });
    if (beside == given.end() && !table.has(key)) continue;
    if (beside != given.end() && (table.has(key) || beside->values.size() > 1))
      throw InputError(key, beside->values.back(),
                       "must be one value, or a column of the table of points, not both");
    if (beside == given.end())
      add_column(table, key, list.axes);
    else
      list.axes.push_back({key, std::vector(table.rows(), beside->values.front())});
    for (std::size_t row = 0; row < table.rows(); ++row)
      list.points[row].values.push_back(list.axes.back().values[row]);
  }
  return list;
}

void refuse_twins(const SweepPoints& points) {
  std::set<std::vector<std::string>> seen;
  for (const SweepPoint& point : points.points)
    if (!seen.insert(point.values).second)
      throw InputError("the point " + points.name(point) + " is given twice");
}

}  // namespace

const std::vector<std::string>& sweep_keys() {
  static const std::vector<std::string> keys{"density",       "radius", "index",
                                             "optical_depth", "g",      "albedo"};
  return keys;
}

std::string SweepPoints::name(const SweepPoint& point) const {
  std::string name;
  for (std::size_t i = 0; i < axes.size(); ++i)
    name += (name.empty() ? "" : "_") + axes[i].key + '=' + point.values[i];
  return name;
}

SceneSpec SweepPoints::scene(SceneSpec base, const SweepPoint& point) const {
  for (std::size_t i = 0; i < axes.size(); ++i) set(base, axes[i].key, point.values[i]);
  return base;
}

void add_sweep_options(Options& options, SweepLists& lists) {
  options.add("--radius", lists.radius, "Radii of soft, hard, tm and te");
  options.add("--index", lists.index,
              "Relative indices of tm and te, as \"1.5+0.1i\" (default 1.5)");
  options.add("--density", lists.density, "Densities as number per area");
  options.add("--g", lists.g, "Mean cosines of hg");
  options.add("--albedo", lists.albedo, "Albedos of hg and of resonant points");
  options.add("--optical_depth", lists.optical_depth, "Densities from mu_t x depth");
  options.add("--points", lists.points,
              "CSV with columns among these keys (and index_imaginary): a list of points in "
              "place of all combinations");
}

SweepPoints sweep_points(const SweepLists& lists) {
  SweepPoints points;
  if (lists.points.empty()) {
    points.axes = given_axes(lists);
    points.points = product(points.axes);
  } else {
    points = listed(lists);
  }
  refuse_twins(points);
  return points;
}

}  // namespace flatspeckle::apps
