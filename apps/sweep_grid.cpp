#include "apps/sweep_grid.h"

#include <algorithm>

#include "core/keys/number_text.h"

namespace flatspeckle::apps {

namespace {

/// What has a value at each point.
struct Quantity {
  std::string name, units, long_name;
  double (*value)(const Scene&);
};

/// Of the scatterers: an axis where they are swept.
const Quantity settings[] = {{"density", "1/length^2", "scatterers per area",
                              [](const Scene& scene) { return scene.medium.density; }},
                             {"radius", "length", "radius of the disks",
                              [](const Scene& scene) { return scene.scatterer.radius; }},
                             {"index", "1", "relative index, real part",
                              [](const Scene& scene) { return scene.scatterer.index.real(); }}};

/// Of the bulk: an axis where it is swept or the same everywhere.
const Quantity bulk[] = {
    {"optical_depth", "1", "optical depth mu_t L",
     [](const Scene& scene) { return scene.medium.mu_t * scene.domain.depth; }},
    {"g", "1", "mean cosine of scattering", [](const Scene& scene) { return scene.medium.g; }},
    {"albedo", "1", "single-scattering albedo",
     [](const Scene& scene) { return scene.medium.albedo; }}};

const Quantity small_parameter = {
    "k_mean_free_path", "1", "wavenumber times mean free path",
    [](const Scene& scene) { return scene.k * scene.medium.mean_free_path(); }};

const Quantity absorbing_index = {"index_imaginary", "1", "relative index, imaginary part",
                                  [](const Scene& scene) { return scene.scatterer.index.imag(); }};

std::vector<double> values_of(const Quantity& quantity, const std::vector<Scene>& scenes) {
  std::vector<double> values;
  std::transform(scenes.begin(), scenes.end(), std::back_inserter(values), quantity.value);
  return values;
}

bool is_constant(const std::vector<double>& values) {
  return std::equal(values.begin() + 1, values.end(), values.begin());
}

/// The numbers of an axis that is swept; none of one that is not.
std::vector<double> swept_values(const SweepPlan& plan, const std::string& key) {
  std::vector<double> values;
  for (const SweepAxis& axis : plan.points.axes)
    if (axis.key == key)
      for (const std::string& text : axis.values) values.push_back(parse_complex(key, text).real());
  return values;
}

}  // namespace

std::vector<Axis> write_sweep_grid(ResultFile& file, const SweepPlan& plan,
                                   const std::vector<Scene>& scenes, bool as_list) {
  std::vector<Axis> grid;
  const auto add_axis = [&](const Quantity& quantity, const std::vector<double>& values) {
    file.scale(quantity.name, values, quantity.units, quantity.long_name);
    grid.emplace_back(quantity.name);
  };
  std::vector<Quantity> beside;
  if (as_list) {
    file.numbered_scale("point", scenes.size(), "number of the point");
    grid.emplace_back("point");
  }
  for (const Quantity& quantity : settings) {
    const auto swept = swept_values(plan, quantity.name);
    if (swept.size() < 2) continue;
    if (as_list)
      beside.push_back(quantity);
    else
      add_axis(quantity, swept);
    const bool lossless = is_constant(values_of(absorbing_index, scenes)) &&
                          scenes.front().scatterer.index.imag() == 0;
    if (quantity.name == "index" && !lossless) beside.push_back(absorbing_index);
  }
  for (const Quantity& quantity : bulk) {
    const auto swept = swept_values(plan, quantity.name);
    const auto values = values_of(quantity, scenes);
    if (as_list || (swept.empty() && !is_constant(values)))
      beside.push_back(quantity);
    else
      add_axis(quantity, swept.empty() ? std::vector{values.front()} : swept);
  }
  beside.push_back(small_parameter);
  for (const Quantity& quantity : beside)
    file.dataset(quantity.name, values_of(quantity, scenes), grid, quantity.units,
                 quantity.long_name);
  return grid;
}

}  // namespace flatspeckle::apps
