#include <algorithm>

#include "apps/results/datasets.h"
#include "apps/sweep/curve_result.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"

namespace flatspeckle::apps {

const DatasetTable sweep_axes_table{
    "sweep axes",
    {{"density", Data::scale, "", "1/length^2", "scatterers per area"},
     {"radius", Data::scale, "", "length", "radius of the disks"},
     {"index", Data::scale, "", "1", "relative index, real part"},
     {"optical_depth", Data::scale, "", "1", "optical depth mu_t L"},
     {"g", Data::scale, "", "1", "mean cosine of scattering"},
     {"albedo", Data::scale, "", "1", "single-scattering albedo"},
     {"point", Data::numbers, "", "1", "number of the point"}}};

namespace {

/// What has a value at each point.
struct Quantity {
  std::string name;
  double (*value)(const Scene&);
};

/// Of the scatterers: an axis where they are swept.
const Quantity settings[] = {
    {"density", [](const Scene& scene) { return scene.medium.density; }},
    {"radius", [](const Scene& scene) { return scene.scatterer.radius; }},
    {"index", [](const Scene& scene) { return scene.scatterer.index.real(); }}};

/// Of the bulk: an axis where it is swept or the same everywhere.
const Quantity bulk[] = {
    {"optical_depth", [](const Scene& scene) { return scene.medium.mu_t * scene.domain.depth; }},
    {"g", [](const Scene& scene) { return scene.medium.g; }},
    {"albedo", [](const Scene& scene) { return scene.medium.albedo; }}};

const Quantity small_parameter = {
    "k_mean_free_path", [](const Scene& scene) { return scene.k * scene.medium.mean_free_path(); }};

const Quantity absorbing_index = {"index_imaginary",
                                  [](const Scene& scene) { return scene.scatterer.index.imag(); }};

bool is_constant(const std::vector<double>& values) {
  return std::equal(values.begin() + 1, values.end(), values.begin());
}

/// The numbers of an axis that is swept; none of one that is not.
std::vector<double> swept_values(const CurveSweep& sweep, const std::string& key) {
  std::vector<double> values;
  for (const SweepAxis& axis : sweep.points().axes)
    if (axis.key == key)
      for (const std::string& text : axis.values.texts())
        values.push_back(parse_complex(key, text).real());
  return values;
}

}  // namespace

void write_sweep_grid(ResultFile& file, const CurveSweep& sweep, const std::vector<Scene>& scenes,
                      bool as_list) {
  const ResultGroup axes(file, sweep_axes_table), root(file, sweep_table);
  std::vector<Axis> grid;
  std::vector<Quantity> beside{small_parameter};
  if (as_list) {
    axes.number("point", scenes.size());
    grid.emplace_back("point");
  }
  const auto add = [&](const Quantity& quantity, const std::vector<double>& values, bool is_axis) {
    if (as_list || !is_axis) return beside.push_back(quantity);
    axes.put(quantity.name, values);
    grid.emplace_back(quantity.name);
  };
  for (const Quantity& quantity : settings) {
    const auto swept = swept_values(sweep, quantity.name);
    if (swept.size() < 2) continue;
    add(quantity, swept, true);
    const auto absorbing = column(scenes, absorbing_index.value);
    if (quantity.name == "index" && (!is_constant(absorbing) || absorbing.front() != 0))
      beside.push_back(absorbing_index);
  }
  for (const Quantity& quantity : bulk) {
    const auto swept = swept_values(sweep, quantity.name), values = column(scenes, quantity.value);
    add(quantity, swept.empty() ? std::vector{values.front()} : swept,
        !swept.empty() || is_constant(values));
  }
  file.bind("GRID", grid);
  for (const Quantity& quantity : beside) root.put(quantity.name, column(scenes, quantity.value));
}

}  // namespace flatspeckle::apps
